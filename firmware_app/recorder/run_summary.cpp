#include "firmware_app/recorder/run_summary.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <spdlog/fmt/fmt.h>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/recorder/bus_summary.hpp"

namespace patella::app {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kMicroseconds = 1e-3;  // per nanosecond

Json distribution(const LatencyHistogram& histogram) {
  const auto at = [&](double quantile) {
    return kMicroseconds * static_cast<double>(histogram.quantile(quantile));
  };
  Json out;
  out["count"] = histogram.count();
  out["p50_us"] = at(0.5);
  out["p99_us"] = at(0.99);
  out["p99_9_us"] = at(0.999);
  out["max_us"] = kMicroseconds * static_cast<double>(histogram.maximum());
  Json& buckets = out["histogram_lower_us_upper_us_count"] = Json::array();
  histogram.forEach([&](std::int64_t lower_ns, std::int64_t upper_ns, std::uint64_t count) {
    buckets.push_back({kMicroseconds * static_cast<double>(lower_ns),
                       kMicroseconds * static_cast<double>(upper_ns), count});
  });
  return out;
}

Json errors(const ErrorStatistics& statistics, int joints) {
  Json out;
  out["samples"] = statistics.count;
  const auto n = static_cast<double>(statistics.count);
  for (int i = 0; i < joints; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    out["mean_rad_s2"].push_back(statistics.sum[joint] / n);
    out["rms_rad_s2"].push_back(std::sqrt(statistics.sum_of_squares[joint] / n));
    out["max_rad_s2"].push_back(statistics.maximum[joint]);
  }
  return out;
}

Json inputs(const std::vector<InputFile>& files) {
  Json out;
  for (const InputFile& file : files) {
    out[file.role] = {{"file", file.path.filename().string()}, {"sha256", file.sha256}};
  }
  return out;
}

}  // namespace

std::vector<InputFile> inputFiles(const RunConfig& config) {
  std::vector<InputFile> files;
  const auto add = [&](const std::string& role, const std::filesystem::path& path) {
    if (!path.empty()) {
      files.push_back({role, path, fileSha256(path)});
    }
  };
  const auto addAll = [&add](const std::string& role, const std::vector<std::filesystem::path>& paths) {
    for (std::size_t i = 0; i < paths.size(); ++i) {
      add(role + "_" + std::to_string(i + 1), paths[i]);
    }
  };
  add("configuration", config.path);
  add("model", config.model_path);
  addAll("model_urdf", config.model_urdfs);
  add("reference", config.reference_path);
  add("bus_map", config.bus_map_path);
  add("dbc", config.bus.dbc_path);
  addAll("data_sheet", config.bus.data_sheets);
  add("weights", config.weights_path);
  add("faults", config.faults_path);
  if (config.backend.kind == BackendKind::kSim) {
    add("rig_model", config.rig_model_path);
    addAll("rig_model_urdf", config.rig_model_urdfs);
    add("rig_emg_log", config.rig.emg_log);
  }
  if (config.backend.kind == BackendKind::kReplay) {
    add("log", config.backend.target);
  }
  return files;
}

std::vector<std::string> changedFiles(const std::vector<InputFile>& files) {
  std::vector<std::string> changed;
  for (const InputFile& file : files) {
    std::string now;
    try {
      now = fileSha256(file.path);
    } catch (const FileError&) {
      now.clear();  // gone, or not to be read: not as it was
    }
    if (now != file.sha256) {
      changed.push_back(file.role);
    }
  }
  return changed;
}

namespace {

Json safety(const RunConfig& config, const LoopStatistics& loop) {
  Json out;
  out["final_state"] = safety::stateName(loop.final_state);
  out["stops"] = loop.stops;
  out["latched"] = Json::array();
  out["faults"] = Json::object();
  for (int i = 0; i < safety::kFaultCount; ++i) {
    const auto fault = static_cast<safety::Fault>(i);
    const auto index = static_cast<std::size_t>(i);
    if (loop.latched.has(fault)) {
      out["latched"].push_back(safety::faultName(fault));
    }
    if (loop.fault_events[index] != 0) {
      out["faults"][std::string(safety::faultName(fault))] = {{"events", loop.fault_events[index]},
                                                              {"ticks", loop.fault_ticks[index]}};
    }
  }
  for (int i = 0; i < safety::kWarningCount; ++i) {
    if (const std::uint64_t ticks = loop.warning_ticks[static_cast<std::size_t>(i)]; ticks != 0) {
      out["warnings"][std::string(safety::warningName(static_cast<safety::Warning>(i)))] = {{"ticks", ticks}};
    }
  }
  for (int i = 0; i < safety::kStateCount; ++i) {
    out["ticks_in_state"][std::string(safety::stateName(static_cast<safety::State>(i)))] =
        loop.state_ticks[static_cast<std::size_t>(i)];
  }
  out["ticks_limited"] = loop.limit_ticks;
  out["max_torque_Nm"] = loop.max_torque_Nm;
  for (int i = 0; i < config.model.joints(); ++i) {
    out["torque_limit_Nm"].push_back(config.tick.limits.joint[static_cast<std::size_t>(i)].torque_Nm);
  }
  return out;
}

Json realtimeJson(const RealtimeReport& report) {
  Json out;
  out["degraded"] = report.degraded();
  out["policy"] = report.policy;
  out["priority"] = report.priority;
  out["memory_locked"] = report.memory_locked;
  out["cpus"] = report.cpus;
  out["cpu_dma_latency_held"] = report.cpu_dma_latency_held;
  out["preempt_rt"] = report.preempt_rt;
  out["governor"] = report.governor;
  out["missing"] = Json::array();
  for (const Finding& finding : report.findings) {
    if (!finding.ok) {
      out["missing"].push_back({{"name", finding.name}, {"found", finding.found}, {"fix", finding.fix}});
    }
  }
  return out;
}

// Errors of everybody who estimates, where a simulated rig tells the truth, and how the network's compares
// with the smaller of the observer's two.
void estimation(const RunConfig& config, const LoopStatistics& loop, Json& out) {
  const int joints = config.model.joints();
  if (loop.sampler_error.count == 0) {
    return;
  }
  Json& estimates = out["estimation_error"];
  estimates["sampler"] = errors(loop.sampler_error, joints);
  if (config.tick.estimate_cutoff_Hz > 0.0) {
    estimates["sampler_filtered"] = errors(loop.filtered_error, joints);
  }
  if (loop.network_error.count == 0) {
    return;
  }
  estimates["network"] = errors(loop.network_error, joints);
  for (int i = 0; i < joints; ++i) {
    const auto joint = static_cast<std::size_t>(i);
    const auto mean = [joint](const ErrorStatistics& s) {
      return s.sum[joint] / static_cast<double>(s.count);
    };
    const double observer = std::min(mean(loop.sampler_error), mean(loop.filtered_error));
    out["network"]["error_to_observer"].push_back(mean(loop.network_error) / observer);
  }
}

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

// What the network is worth here, in words, and when its output is there.
std::string networkText(const Json& s) {
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

}  // namespace

Json summarise(const RunConfig& config, const std::vector<InputFile>& files, const LoopStatistics& loop,
               const can::Bus& bus, const can::MeasurementDecoder& decoder, const Recorder& recorder,
               const RealtimeReport* realtime) {
  const int joints = config.model.joints();
  Json out;
  out["patella"] = PATELLA_VERSION;
  out["backend"] = config.backend.kind == BackendKind::kSim   ? "sim"
                   : config.backend.kind == BackendKind::kCan ? "can:" + config.backend.target
                                                              : "replay";
  out["clock"] = config.clock == ClockKind::kVirtual ? "virtual" : "monotonic";
  out["rate_Hz"] = config.loop.rate_Hz;
  out["observer"] = observerName(config.observer.kind);
  out["ticks"] = loop.ticks;
  out["inputs"] = inputs(files);
  if (config.weights) {
    out["inputs"]["weights"]["digest"] = config.weights_sealed ? "right" : "none";
  }
  if (config.backend.kind == BackendKind::kSim) {
    out["seed"] = config.rig.seed;
  }
  if (realtime != nullptr) {
    out["realtime"] = realtimeJson(*realtime);
  }
  out["timing"] = {{"wakeup_latency", distribution(loop.wakeup)},
                   {"execution", distribution(loop.execution)},
                   {"sensor_to_torque", distribution(loop.sensor_to_torque)},
                   {"overruns", loop.overruns},
                   {"missed_periods", loop.missed_periods}};
  Json& thread = out["loop_thread"];
  thread["heap_counted"] = loop.heap_counted;
  thread["heap_allocations"] = loop.heap_allocations;
  thread["heap_frees"] = loop.heap_frees;
  thread["minor_page_faults"] = loop.minor_page_faults;
  thread["major_page_faults"] = loop.major_page_faults;
  if (realtime != nullptr) {
    thread["voluntary_context_switches"] = loop.voluntary_switches;
    thread["involuntary_context_switches"] = loop.involuntary_switches;
  }
  addBuses(config, loop, bus, decoder, out);
  out["safety"] = safety(config, loop);
  if (const std::vector<std::string> changed = changedFiles(files); !changed.empty()) {
    out["safety"]["warnings"][std::string(warningName(safety::Warning::kFileChanged))]["files"] = changed;
  }
  if (config.weights) {
    out["network"] = {{"rate_Hz", config.weights->rate_Hz},
                      {"compensates", config.tick.compensation == tick::CompensationSource::kNetwork}};
  }
  estimation(config, loop, out);
  if (loop.tracking_count > 0) {
    const auto rms = [&](const PerJoint& sum_of_squares, int joint) {
      return std::sqrt(sum_of_squares[static_cast<std::size_t>(joint)] /
                       static_cast<double>(loop.tracking_count));
    };
    for (int i = 0; i < joints; ++i) {
      out["f_s_filtered_rms_rad_s2"].push_back(rms(loop.f_s_sum_of_squares, i));
      out["d_hat_rms_Nm"].push_back(rms(loop.d_hat_sum_of_squares, i));
      out["tracking_rms_rad"].push_back(rms(loop.tracking_sum_of_squares, i));
    }
  }
  out["recorder"] = {{"ticks_written", recorder.writtenTicks()},
                     {"ticks_dropped", recorder.droppedTicks()},
                     {"frames_written", recorder.writtenFrames()},
                     {"frames_dropped", recorder.droppedFrames()},
                     {"error", recorder.error()}};
  return out;
}

namespace {

// A log that was played to its end, against what the loop said then.
std::string replayText(const Json& replay) {
  const auto recorded = replay["recorded_commands"].get<std::uint64_t>();
  const auto different = replay["different_commands"].get<std::uint64_t>();
  if (recorded == 0 || replay["frames_played"] != replay["frames"]) {
    return {};
  }
  return different == 0
             ? fmt::format("  commands: all {} as in the log\n", recorded)
             : fmt::format("  commands: {} unlike those of the log, which has {}\n", different, recorded);
}

}  // namespace

std::string summaryText(const Json& s) {
  std::string text =
      fmt::format("{} ticks at {} Hz, backend {}, clock {}, observer {}\n", s["ticks"].get<std::uint64_t>(),
                  s["rate_Hz"].get<double>(), s["backend"].get<std::string>(), s["clock"].get<std::string>(),
                  s["observer"].get<std::string>());
  if (s["inputs"].contains("weights") && s["inputs"]["weights"]["digest"] == "none") {
    text += "  the weights have no digest: damage to them would go unseen\n";
  }
  if (s.contains("realtime")) {
    const Json& r = s["realtime"];
    text += fmt::format("  {} priority {}, memory {}, PREEMPT_RT {}, governor {}{}\n",
                        r["policy"].get<std::string>(), r["priority"].get<int>(),
                        r["memory_locked"].get<bool>() ? "locked" : "not locked",
                        r["preempt_rt"].get<bool>() ? "yes" : "no", r["governor"].get<std::string>(),
                        r["degraded"].get<bool>() ? " — DEGRADED, see patella check" : "");
    text += fmt::format("\n  {:<22}{:>9}{:>9}{:>9}{:>9}\n", "timing, µs", "p50", "p99", "p99.9", "max");
    text += timingLine(s, "wakeup_latency", "wake-up latency");
    text += timingLine(s, "execution", "execution");
    text += timingLine(s, "sensor_to_torque", "sensor to torque");
  }
  const Json& thread = s["loop_thread"];
  text += fmt::format(
      "\n  overruns {}, missed periods {}, heap operations {}, page faults {}\n",
      s["timing"]["overruns"].get<std::uint64_t>(), s["timing"]["missed_periods"].get<std::uint64_t>(),
      thread["heap_counted"].get<bool>() ? std::to_string(thread["heap_allocations"].get<std::uint64_t>() +
                                                          thread["heap_frees"].get<std::uint64_t>())
                                         : "not counted",
      thread["minor_page_faults"].get<std::uint64_t>() + thread["major_page_faults"].get<std::uint64_t>());
  text += busText(s);
  const Json& safe = s["safety"];
  text += fmt::format("  final state {}, stops {}, largest torque {:.2f} N·m\n",
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
  if (s.contains("estimation_error")) {
    for (const auto& [name, shown] : kEstimates) {
      if (s["estimation_error"].contains(name)) {
        const Json& error = s["estimation_error"][name];
        text +=
            fmt::format("  |f_u − estimate| of the {}, rad/s²: mean {}, max {}\n", shown,
                        perJoint(error["mean_rad_s2"], "{:.4f}"), perJoint(error["max_rad_s2"], "{:.4f}"));
      }
    }
  }
  if (s.contains("network")) {
    text += networkText(s);
  }
  if (s.contains("tracking_rms_rad")) {
    text +=
        fmt::format("  unknown to the model, rms: {} rad/s², {} N·m\n",
                    perJoint(s["f_s_filtered_rms_rad_s2"], "{:.3f}"), perJoint(s["d_hat_rms_Nm"], "{:.3f}"));
    text += fmt::format("  tracking error rms {} rad\n", perJoint(s["tracking_rms_rad"], "{:.4f}"));
  }
  if (s.contains("replay")) {
    text += replayText(s["replay"]);
  }
  const Json& rec = s["recorder"];
  text += fmt::format("  recorded {} ticks and {} frames, dropped {} and {}\n",
                      rec["ticks_written"].get<std::uint64_t>(), rec["frames_written"].get<std::uint64_t>(),
                      rec["ticks_dropped"].get<std::uint64_t>(), rec["frames_dropped"].get<std::uint64_t>());
  if (!rec["error"].get<std::string>().empty()) {
    text += "  RECORDING FAILED: " + rec["error"].get<std::string>() + "\n";
  }
  return text;
}

}  // namespace patella::app
