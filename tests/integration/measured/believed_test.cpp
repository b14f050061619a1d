// Recordings of other people's rigs are believed: with friction that their models lack, drives without
// current, passive joints, joints that stick, pushes by hand, jitter and gaps; and no row of them is taken
// for an outlier.
#include <algorithm>
#include <array>
#include <filesystem>
#include <ranges>
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "firmware_app/files/model_file.hpp"
#include "tests/support/sanitized.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/diagnose/checks/plausibility.hpp"
#include "tools/recordings/recording_file.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

namespace fs = std::filesystem;

const fs::path kSource(checkout::source());
const fs::path kMaps = kSource / "tools/diagnose/maps";
const fs::path kData(checkout::recordings());

constexpr std::size_t kAll = 1000;

struct Rig {
  const char* folder;
  const char* prefix;  ///< of its files
  const char* columns;
  fs::path model;
  std::size_t files;
};

std::vector<Rig> rigs() {
  const fs::path c1 = kSource / "firmware_app/config/models/double_pendulum.toml";
  return {
      {"double_pendulum", "run_", "double_pendulum.toml", c1, 3},
      {"emps", "emps", "emps.toml", kMaps / "emps_symmetric.toml", 1},
      {"emps", "emps", "emps.toml", kMaps / "emps_inertia.toml", 1},
      {"measured/dfki_double_pendulum_c1", "c1_", "double_pendulum.toml", c1, 7},
      {"measured/dfki_double_pendulum_c0", "c0_", "double_pendulum.toml",
       kMaps / "double_pendulum_c0_model.toml", 9},
      {"measured/dfki_simple_pendulum", "sp_", "simple_pendulum.toml", kMaps / "simple_pendulum_model.toml",
       7},
      {"measured/acromonk", "am_", "acromonk.toml", kMaps / "acromonk_model.toml", 4},
      {"measured/multiarm_pendulum", "map_single", "free_pendulum.toml", kMaps / "free_pendulum_model.toml",
       2},
      {"measured/multiarm_pendulum", "map_double", "free_double_pendulum.toml",
       kMaps / "free_double_pendulum_model.toml", 1},
      {"measured/multiarm_pendulum", "map_triple", "free_triple_pendulum.toml",
       kMaps / "free_triple_pendulum_model.toml", 1},
  };
}

std::set<fs::path> filesOf(const Rig& rig) {
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(kData / rig.folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(rig.prefix) && name.ends_with(".csv")) {
      files.insert(entry.path());
    }
  }
  return files;
}

}  // namespace

TEST_CASE("recordings of other people's rigs are believed, row by row") {
  for (const Rig& rig : rigs()) {
    const model::ModelDescription model = app::loadModel(rig.model);
    const std::set<fs::path> files = filesOf(rig);
    CHECK(files.size() == rig.files);
    for (const fs::path& file : files | std::views::take(test::unlessSanitized(kAll, std::size_t{1}))) {
      CAPTURE(file.string());
      const Recording recording =
          loadRecording(file, {.joints = model.joints(), .columns = kMaps / rig.columns});
      CHECK_NOTHROW(requirePlausible(std::array{recording}, model));
      for (const std::string& warning : recording.warnings) {
        CAPTURE(warning);
        CHECK(warning.find("left out") == std::string::npos);
      }
    }
  }
}
