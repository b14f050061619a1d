// Recordings of other people's rigs, with what reads them and the model that their makers publish.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::bench {

struct MeasuredRecording {
  std::string rig;   ///< folder
  std::string name;  ///< file
  model::ModelDescription model;
  diagnose::Recording recording;
  bool by_hand = false;  ///< a person moved or pushed it, and nothing measured how
};

/// All that move and are no table, in a fixed order. `data`: folder that holds emps, double_pendulum and
/// measured; `source`: the project's. Throws app::FileError where a folder is absent.
std::vector<MeasuredRecording> measuredRecordings(const std::filesystem::path& data,
                                                  const std::filesystem::path& source);

}  // namespace patella::bench
