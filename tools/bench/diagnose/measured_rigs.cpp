#include "tools/bench/diagnose/measured_rigs.hpp"

#include <set>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/model_file.hpp"
#include "tools/recordings/recording_file.hpp"

namespace patella::bench {
namespace {

namespace fs = std::filesystem;

struct RigFiles {
  const char* folder;
  const char* prefix;  ///< of its files
  const char* columns;
  fs::path model;
};

std::vector<RigFiles> rigs(const fs::path& source) {
  const fs::path maps = source / "tools/diagnose/maps";
  const fs::path c1 = source / "firmware_app/config/models/double_pendulum.toml";
  return {
      {"double_pendulum", "run_", "double_pendulum.toml", c1},
      {"emps", "emps", "emps.toml", maps / "emps_symmetric.toml"},
      {"measured/dfki_double_pendulum_c1", "c1_", "double_pendulum.toml", c1},
      {"measured/dfki_double_pendulum_c0", "c0_", "double_pendulum.toml",
       maps / "double_pendulum_c0_model.toml"},
      {"measured/dfki_simple_pendulum", "sp_", "simple_pendulum.toml", maps / "simple_pendulum_model.toml"},
      {"measured/acromonk", "am_", "acromonk.toml", maps / "acromonk_model.toml"},
      {"measured/multiarm_pendulum", "map_single", "free_pendulum.toml", maps / "free_pendulum_model.toml"},
      {"measured/multiarm_pendulum", "map_double", "free_double_pendulum.toml",
       maps / "free_double_pendulum_model.toml"},
      {"measured/multiarm_pendulum", "map_triple", "free_triple_pendulum.toml",
       maps / "free_triple_pendulum_model.toml"},
  };
}

bool movedByHand(const std::string& name) {
  return name == "sp_energy_shaping_pushed" || name == "sp_gravity_compensation";
}

std::set<fs::path> filesOf(const fs::path& folder, const std::string& prefix) {
  if (!fs::is_directory(folder)) {
    throw app::FileError(folder.string() + ": is not there, expected a folder of recordings");
  }
  std::set<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name.starts_with(prefix) && entry.path().extension() == ".csv") {
      files.insert(entry.path());
    }
  }
  return files;
}

}  // namespace

std::vector<MeasuredRecording> measuredRecordings(const fs::path& data, const fs::path& source) {
  std::vector<MeasuredRecording> all;
  for (const RigFiles& rig : rigs(source)) {
    const model::ModelDescription model = app::loadModel(rig.model);
    for (const fs::path& file : filesOf(data / rig.folder, rig.prefix)) {
      all.push_back(
          {.rig = rig.folder,
           .name = file.stem().string(),
           .model = model,
           .recording = diagnose::loadRecording(
               file, {.joints = model.joints(), .columns = source / "tools/diagnose/maps" / rig.columns}),
           .by_hand = movedByHand(file.stem().string())});
    }
  }
  return all;
}

}  // namespace patella::bench
