// Fault scripts: TOML with one [[fault]] for everything that is to go wrong.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "sim/fault_script.hpp"

namespace patella::app {

/// The program that acts the script out, and so the kinds that it may hold.
enum class FaultStage {
  kInProcess,  ///< loop and rig in one process: everything
  kRig,        ///< the rig as a process of its own: all but what happens to the loop's host
  kLoop        ///< the loop on a bus or a log: only what happens to its host
};

/// Events in the order of the file; they may name encoders and drives of `joints`, and one of `buses`. Throws
/// FileError naming file, line and key.
std::vector<sim::FaultEvent> loadFaultScript(const std::filesystem::path& path, FaultStage stage, int joints,
                                             const std::vector<std::string>& buses = {});

}  // namespace patella::app
