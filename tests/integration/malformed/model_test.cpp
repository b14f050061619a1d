// Models of the leg with one defect each.
#include <doctest/doctest.h>

#include "tests/integration/malformed/patella_process.hpp"

using namespace patella::test;

TEST_CASE("a model that cannot be read") {
  expectRefused({
      {"missing",
       removed(kModel),
       {"adult.toml:", ": key 'model'", "there is no file", "models/adult.toml"},
       {}},
      {"folder",
       turnedIntoFolder(kModel),
       {"models/adult.toml: is a directory, expected a regular file"},
       {}},
      {"empty", written(kModel, ""), {"models/adult.toml:1:", "'mechanism' is missing"}, {}},
      {"named on the command line and missing",
       none(),
       {"nowhere.toml: cannot be opened: No such file"},
       {"--model", "{dir}nowhere.toml"}},
      {"of the rig, missing",
       removed(kRigModel),
       {"adult.toml:", ": key 'rig.model'", "there is no file", "adult_rubbing.toml"},
       {}},
  });
}

TEST_CASE("a mechanism that cannot exist") {
  expectRefused({
      {"negative mass",
       replaced(kModel, "mass_kg = [7.2, 4.392]", "mass_kg = [7.2, -4.392]"),
       {"models/adult.toml:{line}: key 'mechanism.mass_kg': value -4.392, expected", "[0.001, 50]"},
       {}},
      {"negative inertia",
       replaced(kModel, "0.12160991232]", "-0.12160991232]"),
       {"models/adult.toml:{line}: key 'mechanism.inertia_kg_m2': value -0.12160991232, expected"},
       {}},
      {"link that nothing would hold back",
       [](Workshop& workshop) {
         workshop.replace(kModel, "0.12160991232]", "0]");
         workshop.replace(kModel, "com_m = [0.1732, 0.2424]", "com_m = [0.1732, 0]");
       },
       {"models/adult.toml: inertia_kg_m2[2] + mass_kg[2] com_m[2]²", "0", "expected"},
       {}},
      {"one link's length",
       replaced(kModel, "length_m = [0.4, 0.4]", "length_m = [0.4]"),
       {"models/adult.toml:{line}: key 'mechanism.length_m': 1 elements, expected an array of 2"},
       {}},
      {"unknown kind",
       replaced(kModel, "kind = \"planar_two_link\"", "kind = \"hexapod\""),
       {"models/adult.toml:{line}: key 'mechanism.kind': value 'hexapod'", "'planar_two_link'"},
       {}},
  });
}

TEST_CASE("an effect that the loop does not have") {
  const std::string first = "kind = \"viscous_friction\"\njoint = 1";
  expectRefused({
      {"unknown effect",
       replaced(kModel, first, "kind = \"magic_friction\"\njoint = 1"),
       {"models/adult.toml:{line}: key 'effect[1].kind': value 'magic_friction'", "'viscous_friction'"},
       {}},
      {"unknown parameter",
       replaced(kModel, first, "kind = \"viscous_friction\"\ncoeficient_Nms_rad = 1\njoint = 1"),
       {"models/adult.toml:", "'effect[1].coeficient_Nms_rad' is unknown"},
       {}},
      {"missing parameter",
       replaced(kModel, first, "kind = \"coulomb_friction\"\njoint = 1"),
       {"models/adult.toml:", "'effect[1].", "is missing"},
       {}},
      {"joint of another leg",
       replaced(kModel, first, "kind = \"viscous_friction\"\njoint = 3"),
       {"models/adult.toml:", "'effect[1].joint': value 3, expected an integer in [1, 2]"},
       {}},
      {"driving friction",
       [](Workshop& workshop) {
         workshop.write(kModel, workshop.read(kModel) +
                                    "\n[[effect]]\nkind = \"viscous_friction\"\njoint = 1\n"
                                    "coefficient_Nms_rad = -0.1\n");
       },
       {"models/adult.toml:", "'effect[3].coefficient_Nms_rad': value -0.1, expected a number in [0, 1000]"},
       {}},
  });
}
