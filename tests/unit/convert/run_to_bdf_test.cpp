#include "tools/convert/run_to_bdf.hpp"

#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella;
using patella::test::ScratchFolder;

TEST_CASE("a conversion to BDF+ leaves the file of another that is under way alone") {
  const ScratchFolder folder;
  app::writeFile(folder / "ticks.csv", "t_s,q1_rad\n0,0.1\n0.01,0.2\n0.02,-0.3\n");
  app::AtomicFile another(folder / "run.bdf");
  another.write("another's");
  app::writeFile(folder / "run.bdf.partial", "what somebody keeps there");
  const convert::BdfReport report = convert::convertRunToBdf(folder.path(), folder / "run.bdf");
  CHECK(report.samples == 3);
  CHECK(app::readFile(folder / "run.bdf")
            .starts_with("\xFF"
                         "BIOSEMI"));
  CHECK(app::readFile(folder / "run.bdf.partial") == "what somebody keeps there");
  another.commit();
  CHECK(app::readFile(folder / "run.bdf") == "another's");
  CHECK(folder.entries() == 3);
}

TEST_CASE("a BDF+ file that cannot be made says why, and one that is not whole leaves nothing") {
  const ScratchFolder folder;
  const auto refused = [&](const std::filesystem::path& bdf) {
    return test::messageOf<app::FileError>([&] { convert::convertRunToBdf(folder.path(), bdf); });
  };
  app::writeFile(folder / "ticks.csv", "t_s,q1_rad\n0,0.1\n0.01,0.2\n");
  CHECK(refused(folder / "absent/run.bdf") ==
        (folder / "absent/run.bdf").string() + ": cannot be created: No such file or directory");
  CHECK(refused("/dev/null") == "/dev/null: cannot be replaced, expected a regular file or a new name");
  app::writeFile(folder / "ticks.csv", "t_s,q1_rad\n0,6e6\n0.01,0.2\n");
  CHECK(refused(folder / "run.bdf").find("a value beyond 5000000") != std::string::npos);
  CHECK(folder.entries() == 1);
}
