#include "firmware_app/recorder/input_files.hpp"

#include <cstddef>

#include <spdlog/fmt/fmt.h>

#include "firmware_app/files/atomic_file.hpp"

namespace patella::app {

std::vector<InputFile> inputFiles(const RunConfig& config) {
  std::vector<InputFile> files;
  const auto add = [&](const std::string& role, const std::filesystem::path& path) {
    if (!path.empty()) {
      files.push_back({role, path, fileSha256(path)});
    }
  };
  const auto addAll = [&add](const std::string& role, const std::vector<std::filesystem::path>& paths) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      add(role + "_" + std::to_string(i + 1), paths[i]);
    }
  };
  add("configuration", config.path);
  add("model", config.model_path);
  addAll("model_urdf", config.model_urdfs);
  add("reference", config.reference_path);
  add("bus_map", config.bus_map_path);
  add("dbc", config.bus.dbc_path);
  addAll("data_sheet", config.bus.data_sheets);
  add("weights", config.weights_path);
  add("faults", config.faults_path);
  if (config.backend.kind == BackendKind::kSim) {
    add("rig_model", config.rig_model_path);
    addAll("rig_model_urdf", config.rig_model_urdfs);
    add("rig_emg_log", config.rig.emg_log);
  }
  if (config.backend.kind == BackendKind::kReplay) {
    add("log", config.backend.target);
  }
  return files;
}

std::vector<std::string> changedFiles(const std::vector<InputFile>& files) {
  std::vector<std::string> changed;
  for (const InputFile& file : files) {
    std::string now;
    try {
      now = fileSha256(file.path);
    } catch (const FileError&) {
      now.clear();  // gone, or not to be read: not as it was
    }
    if (now != file.sha256) {
      changed.push_back(file.role);
    }
  }
  return changed;
}

std::string inputLines(const std::vector<InputFile>& files) {
  std::string text;
  for (const InputFile& file : files) {
    text +=
        fmt::format("input={} file={} sha256={}\n", file.role, file.path.filename().string(), file.sha256);
  }
  return text;
}

formats::RunInputs mcapInputs(const std::vector<InputFile>& files) {
  formats::RunInputs inputs;
  inputs.hashes.name = "inputs";
  for (const InputFile& file : files) {
    const std::string name = file.path.filename().string();
    inputs.hashes.values[file.role] = name + " sha256=" + file.sha256;
    if (file.role != "log") {
      inputs.files.push_back({.name = name,
                              .media_type = formats::mediaType(name),
                              .data = readFile(file.path, files::kWeightsFile)});
    }
  }
  return inputs;
}

}  // namespace patella::app
