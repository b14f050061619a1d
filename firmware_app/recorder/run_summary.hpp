// What a run came to, as summary.json holds it.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "drivers/can/bus.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/realtime/realtime_setup.hpp"
#include "firmware_app/recorder/input_files.hpp"
#include "firmware_app/recorder/loop_statistics.hpp"
#include "firmware_app/recorder/recorder.hpp"

namespace patella::app {

/// Only what the run determines, no date and no path of the output, so that two equal runs have equal
/// summaries. `realtime` may be null: then (virtual clock) nothing of the host is in it.
nlohmann::ordered_json summarise(const RunConfig& config, const std::vector<InputFile>& files,
                                 const LoopStatistics& loop, const can::Bus& bus,
                                 const can::MeasurementDecoder& decoder, const Recorder& recorder,
                                 const RealtimeReport* realtime);

}  // namespace patella::app
