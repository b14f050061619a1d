#include "firmware_app/recorder/bus_summary.hpp"

#include <cstddef>
#include <cstdint>

#include <spdlog/fmt/fmt.h>

namespace patella::app {

using Json = nlohmann::ordered_json;

namespace {

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

std::string neverReceived(const Json& messages) {
  std::string names;
  for (const auto& [name, message] : messages.items()) {
    if (message["received"] == 0) {
      names += (names.empty() ? "" : ", ") + name;
    }
  }
  return names;
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

std::string busText(const Json& s) {
  std::string text;
  std::uint64_t lost = s["bus"]["receive_dropped"].get<std::uint64_t>();
  std::uint64_t late = 0;
  std::uint64_t corrupt = 0;
  for (const Json& message : s["bus"]["messages"]) {
    lost += message["lost"].get<std::uint64_t>();
    late += message["late"].get<std::uint64_t>();
    corrupt += message["corrupt"].get<std::uint64_t>();
  }
  text += fmt::format("  frames: {} received, {} sent, {} lost, {} late, {} corrupt\n",
                      s["bus"]["frames_received"].get<std::uint64_t>(),
                      s["bus"]["frames_sent"].get<std::uint64_t>(), lost, late, corrupt);
  if (s.contains("buses")) {
    for (const auto& [name, bus] : s["buses"].items()) {
      text +=
          fmt::format("    bus {} on {}: {} received, {} sent, {} not sent, {} ticks with a fault\n", name,
                      bus["interface"].get<std::string>(), bus["frames_received"].get<std::uint64_t>(),
                      bus["frames_sent"].get<std::uint64_t>(), bus["send_failed"].get<std::uint64_t>(),
                      bus["fault_ticks"].get<std::uint64_t>());
    }
  }
  if (const std::string silent = neverReceived(s["bus"]["messages"]);
      !silent.empty() && s["safety"]["final_state"] == "init") {
    text += fmt::format("    the loop stayed in init, and never received: {}\n", silent);
  }
  return text;
}

}  // namespace patella::app
