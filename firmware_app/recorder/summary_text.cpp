#include "firmware_app/recorder/summary_text.hpp"

#include <cstddef>
#include <cstdint>
#include <utility>

#include <spdlog/fmt/fmt.h>

namespace patella::app {
namespace {

using Json = nlohmann::ordered_json;

std::string timingLine(const Json& summary, const char* key, const char* label) {
  const Json& d = summary["timing"][key];
  return fmt::format("  {:<22}{:>9.1f}{:>9.1f}{:>9.1f}{:>9.1f}\n", label, d["p50_us"].get<double>(),
                     d["p99_us"].get<double>(), d["p99_9_us"].get<double>(), d["max_us"].get<double>());
}

constexpr std::pair<const char*, const char*> kEstimates[] = {
    {"sampler", "observer"}, {"sampler_filtered", "observer, filtered"}, {"network", "network"}};

std::string perJoint(const Json& values, const char* format) {
  std::string text;
  for (const Json& value : values) {
    text += (text.empty() ? "" : " / ") + fmt::format(fmt::runtime(format), value.get<double>());
  }
  return text;
}

std::string headText(const Json& s) {
  std::string text =
      fmt::format("{} ticks at {} Hz, backend {}, clock {}, observer {}\n", s["ticks"].get<std::uint64_t>(),
                  s["rate_Hz"].get<double>(), s["backend"].get<std::string>(), s["clock"].get<std::string>(),
                  s["observer"].get<std::string>());
  if (s["inputs"].contains("weights") && s["inputs"]["weights"]["digest"] == "none") {
    text += "  the weights have no digest: damage to them would go unseen\n";
  }
  return text;
}

std::string realtimeText(const Json& s) {
  if (!s.contains("realtime")) {
    return "";
  }
  const Json& r = s["realtime"];
  std::string text = fmt::format("  {} priority {}, memory {}, PREEMPT_RT {}, governor {}{}\n",
                                 r["policy"].get<std::string>(), r["priority"].get<int>(),
                                 r["memory_locked"].get<bool>() ? "locked" : "not locked",
                                 r["preempt_rt"].get<bool>() ? "yes" : "no", r["governor"].get<std::string>(),
                                 r["degraded"].get<bool>() ? " — DEGRADED, see patella check" : "");
  text += fmt::format("\n  {:<22}{:>9}{:>9}{:>9}{:>9}\n", "timing, µs", "p50", "p99", "p99.9", "max");
  text += timingLine(s, "wakeup_latency", "wake-up latency");
  text += timingLine(s, "execution", "execution");
  return text + timingLine(s, "sensor_to_torque", "sensor to torque");
}

std::string loopThreadText(const Json& s) {
  const Json& thread = s["loop_thread"];
  return fmt::format(
      "\n  overruns {}, missed periods {}, heap operations {}, page faults {}\n",
      s["timing"]["overruns"].get<std::uint64_t>(), s["timing"]["missed_periods"].get<std::uint64_t>(),
      thread["heap_counted"].get<bool>() ? std::to_string(thread["heap_allocations"].get<std::uint64_t>() +
                                                          thread["heap_frees"].get<std::uint64_t>())
                                         : "not counted",
      thread["minor_page_faults"].get<std::uint64_t>() + thread["major_page_faults"].get<std::uint64_t>());
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

std::string safetyText(const Json& s) {
  const Json& safe = s["safety"];
  std::string text = fmt::format("  final state {}, stops {}, largest torque {:.2f} N·m\n",
                                 safe["final_state"].get<std::string>(), safe["stops"].get<std::uint64_t>(),
                                 safe["max_torque_Nm"].get<double>());
  for (const auto& [name, counts] : safe["faults"].items()) {
    text += fmt::format("    {}: {} times, {} ticks\n", name, counts["events"].get<std::uint64_t>(),
                        counts["ticks"].get<std::uint64_t>());
  }
  if (safe.contains("warnings")) {
    for (const auto& [name, counts] : safe["warnings"].items()) {
      text += fmt::format("    warning {}: {}\n", name,
                          counts.contains("files")
                              ? counts["files"].dump()
                              : std::to_string(counts["ticks"].get<std::uint64_t>()) + " ticks");
    }
  }
  return text;
}

std::string estimationText(const Json& s) {
  std::string text;
  for (const auto& [name, shown] : kEstimates) {
    if (s.contains("estimation_error") && s["estimation_error"].contains(name)) {
      const Json& error = s["estimation_error"][name];
      text += fmt::format("  |f_u − estimate| of the {}, rad/s²: mean {}, max {}\n", shown,
                          perJoint(error["mean_rad_s2"], "{:.4f}"), perJoint(error["max_rad_s2"], "{:.4f}"));
    }
  }
  return text;
}

// What the network is worth here, in words, and when its output is there.
std::string networkText(const Json& s) {
  if (!s.contains("network")) {
    return "";
  }
  const Json& network = s["network"];
  std::string text;
  if (network.contains("error_to_observer")) {
    const Json& ratios = network["error_to_observer"];
    text += fmt::format("  the network leaves {} of the observer's mean error", perJoint(ratios, "{:.2f}"));
    std::string joints;
    for (std::size_t i = 0; i < ratios.size(); ++i) {
      if (!(ratios[i].get<double>() < 1.0)) {
        joints += fmt::format("{}{}", joints.empty() ? "" : " and ", i + 1);
      }
    }
    text += joints.empty() ? "\n" : fmt::format(": NO BETTER than the observer at joint {}\n", joints);
  }
  text += fmt::format("  network: {} steps a second, {}", network["rate_Hz"].get<double>(),
                      network["compensates"].get<bool>() ? "compensates" : "the observer compensates");
  if (s.contains("realtime")) {
    const Json& latency = s["timing"]["sensor_to_torque"];
    text += fmt::format(", its output within {:.1f} µs of the encoder's frame (p50; p99 {:.1f})",
                        latency["p50_us"].get<double>(), latency["p99_us"].get<double>());
  }
  return text + "\n";
}

std::string trackingText(const Json& s) {
  if (!s.contains("tracking_rms_rad")) {
    return "";
  }
  return fmt::format("  unknown to the model, rms: {} rad/s², {} N·m\n  tracking error rms {} rad\n",
                     perJoint(s["f_s_filtered_rms_rad_s2"], "{:.3f}"), perJoint(s["d_hat_rms_Nm"], "{:.3f}"),
                     perJoint(s["tracking_rms_rad"], "{:.4f}"));
}

// A log that was played to its end, against what the loop said then.
std::string replayText(const Json& s) {
  if (!s.contains("replay")) {
    return "";
  }
  const Json& replay = s["replay"];
  const auto recorded = replay["recorded_commands"].get<std::uint64_t>();
  const auto different = replay["different_commands"].get<std::uint64_t>();
  if (recorded == 0 || replay["frames_played"] != replay["frames"]) {
    return "";
  }
  return different == 0
             ? fmt::format("  commands: all {} as in the log\n", recorded)
             : fmt::format("  commands: {} unlike those of the log, which has {}\n", different, recorded);
}

std::string recorderText(const Json& s) {
  const Json& recorder = s["recorder"];
  const auto error = recorder["error"].get<std::string>();
  return fmt::format("  recorded {} ticks and {} frames, dropped {} and {}\n",
                     recorder["ticks_written"].get<std::uint64_t>(),
                     recorder["frames_written"].get<std::uint64_t>(),
                     recorder["ticks_dropped"].get<std::uint64_t>(),
                     recorder["frames_dropped"].get<std::uint64_t>()) +
         (error.empty() ? "" : "  RECORDING FAILED: " + error + "\n");
}

}  // namespace

std::string summaryText(const Json& summary) {
  return headText(summary) + realtimeText(summary) + loopThreadText(summary) + busText(summary) +
         safetyText(summary) + estimationText(summary) + networkText(summary) + trackingText(summary) +
         replayText(summary) + recorderText(summary);
}

}  // namespace patella::app
