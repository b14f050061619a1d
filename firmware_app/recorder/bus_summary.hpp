// The part of a run's summary that speaks of frames and buses.
#pragma once

#include <nlohmann/json.hpp>

#include "drivers/can/bus.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/recorder/loop_statistics.hpp"

namespace patella::app {

/// "bus": counters of all together and of each message; "buses": of each by name, where there are several.
void addBuses(const RunConfig& config, const LoopStatistics& loop, const can::Bus& bus,
              const can::MeasurementDecoder& decoder, nlohmann::ordered_json& summary);

}  // namespace patella::app
