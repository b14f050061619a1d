// Recordings that are logs of frames.
#pragma once

#include <filesystem>

#include "firmware_app/configuration/bus_map_file.hpp"
#include "tools/recordings/raw_recording.hpp"

namespace patella::diagnose {

/// Decodes a log of `candump -l` as the loop decodes its bus: one row for every encoder sample of all joints,
/// on the time base of the encoder's counter, with the newest of everything else, from the first complete
/// measurement on. Frames within half a sensor period of the first encoder frame are of one sample. Torque is
/// timed as in readLoopTable(), by the stamps of the commands. Throws can::LogError, app::FileError, or
/// std::invalid_argument for a map that does not fit its DBC.
RawRecording readLog(const std::filesystem::path& path, const app::BusDescription& bus, int joints,
                     bool sampled);

}  // namespace patella::diagnose
