// A recording from whatever file it stands in.
#pragma once

#include <filesystem>
#include <optional>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

struct RecordingOptions {
  int joints = 0;  ///< of the model
  /// Map of the columns of a foreign CSV or MATLAB file, see column_map.hpp; without it, columns are named as
  /// the loop names them.
  std::optional<std::filesystem::path> columns{};
  /// For logs of frames: what describes their messages, in place of the description that the bus map names.
  std::optional<std::filesystem::path> dbc{};
  /// For logs of frames: which signal is which input. Without it, that of the loop's own bus.
  std::optional<std::filesystem::path> bus_map{};
  /// In place of what the form of the file implies.
  std::optional<TorqueTiming> torque_timing{};
  /// f_u as a simulated rig published it is wanted, too; only run folders have it.
  bool truth = false;
};

/// Reads one of
///   a folder that `patella run` has left (its ticks.csv), or that table by itself, or its run.mcap,
///   a CSV with columns t_s, q<joint>_rad, tau<joint>_Nm and, where there are any, tau_cmd<joint>_Nm,
///     emg<channel>_mV or activation<channel>, or any text or MATLAB file by a map,
///   a log as `candump -l` writes it, by a bus description.
/// Raw EMG becomes activation by the loop's own chain, scaled to the largest envelope of the recording.
/// Throws app::FileError, can::LogError or can::DbcError, located in the file, for what cannot be repaired:
/// missing columns, cells without a number between others that have one, time that runs back, fewer than 200
/// rows, a bus map that does not fit its DBC or the model.
Recording loadRecording(const std::filesystem::path& path, const RecordingOptions& options);

}  // namespace patella::diagnose
