// Recordings that are tables with the loop's names for their columns.
#pragma once

#include <filesystem>

#include "tools/recordings/raw_recording.hpp"

namespace patella::diagnose {

/// True for the header of a table that the loop has recorded.
bool isLoopTable(const std::filesystem::path& file);

/// Reads a CSV with the loop's names for its columns. Throws app::FileError; `joints` is that of the model.
RawRecording readNamedColumns(const std::filesystem::path& file, int joints);

/// Reads a table that the loop has recorded. Time is that of the encoder's counter, as the loop's estimators
/// have it. A drive reports the torque that it held until the sample, so that each row is given the report of
/// the next. Commands take effect a little after the sample, by the recorded latency, within which torque is
/// mixed from the two rows. `sampled`: the report is what acted at the instant of the sample, and taken as it
/// is. `with_truth`: f_u as a simulated rig published it is read, too, and required.
RawRecording readLoopTable(const std::filesystem::path& file, int joints, bool sampled,
                           bool with_truth = false);

}  // namespace patella::diagnose
