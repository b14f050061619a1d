#include "firmware_app/recorder/bus_summary.hpp"

#include <cstddef>
#include <string>

namespace patella::app {
namespace {

using Json = nlohmann::ordered_json;

Json busCounters(const can::BusStatistics& bus) {
  return {{"frames_received", bus.frames_received}, {"frames_sent", bus.frames_sent},
          {"receive_dropped", bus.receive_dropped}, {"send_failed", bus.send_failed},
          {"error_frames", bus.error_frames},       {"bus_off", bus.bus_off},
          {"error_passive", bus.error_passive}};
}

Json messages(const can::MeasurementDecoder& decoder) {
  Json out;
  for (std::size_t i = 0; i < decoder.messageCount(); ++i) {
    const can::MessageStatistics& m = decoder.statistics(i);
    out[std::string(decoder.messageName(i))] = {
        {"received", m.received},        {"lost", m.lost},         {"late", m.late},
        {"corrupt", m.corrupt},          {"repeated", m.repeated}, {"reordered", m.reordered},
        {"out_of_range", m.out_of_range}};
  }
  return out;
}

}  // namespace

void addBuses(const RunConfig& config, const LoopStatistics& loop, const can::Bus& bus,
              const can::MeasurementDecoder& decoder, Json& out) {
  out["bus"] = busCounters(bus.statistics());
  out["bus"]["unknown_frames"] = decoder.unknownFrames();
  out["bus"]["messages"] = messages(decoder);
  for (std::size_t i = 0; config.buses.size() > 1 && i < config.buses.size(); ++i) {
    Json& one = out["buses"][config.buses[i].name];
    one = {{"interface", config.buses[i].interface}, {"fault_ticks", loop.bus_fault_ticks[i]}};
    one.update(busCounters(bus.statisticsOf(i)));
  }
}

}  // namespace patella::app
