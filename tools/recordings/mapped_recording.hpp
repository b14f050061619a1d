// Recordings in files of any form, by a map of their columns.
#pragma once

#include <filesystem>

#include "tools/recordings/column_map.hpp"
#include "tools/recordings/raw_recording.hpp"

namespace patella::diagnose {

/// Reads text, or a MATLAB file by its ending. `joints` is that of the model. Throws app::FileError located
/// in the file.
RawRecording readMappedRecording(const std::filesystem::path& file, int joints, const ColumnMap& map);

}  // namespace patella::diagnose
