#include "firmware_app/recorder/run_summary.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

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

std::string backendText(const Backend& backend) {
  switch (backend.kind) {
    case BackendKind::kSim:
      return "sim";
    case BackendKind::kCan:
      return "can:" + backend.target;
    case BackendKind::kReplay:
      return "replay";
  }
  return "";
}

Json inputs(const RunConfig& config, const std::vector<InputFile>& files) {
  Json out;
  for (const InputFile& file : files) {
    out[file.role] = {{"file", file.path.filename().string()}, {"sha256", file.sha256}};
  }
  if (config.weights) {
    out["weights"]["digest"] = config.weights_origin.sealed ? "right" : "none";
  }
  return out;
}

Json timing(const LoopStatistics& loop) {
  return {{"wakeup_latency", distribution(loop.wakeup)},
          {"execution", distribution(loop.execution)},
          {"sensor_to_torque", distribution(loop.sensor_to_torque)},
          {"overruns", loop.overruns},
          {"missed_periods", loop.missed_periods}};
}

Json loopThread(const LoopStatistics& loop, bool in_real_time) {
  Json out = {{"heap_counted", loop.heap_counted},
              {"heap_allocations", loop.heap_allocations},
              {"heap_frees", loop.heap_frees},
              {"minor_page_faults", loop.minor_page_faults},
              {"major_page_faults", loop.major_page_faults}};
  if (in_real_time) {
    out["voluntary_context_switches"] = loop.voluntary_switches;
    out["involuntary_context_switches"] = loop.involuntary_switches;
  }
  return out;
}

Json safetyJson(const RunConfig& config, const LoopStatistics& loop, const std::vector<InputFile>& files) {
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
  if (const std::vector<std::string> changed = changedFiles(files); !changed.empty()) {
    out["warnings"][std::string(safety::warningName(safety::Warning::kFileChanged))]["files"] = changed;
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
void addEstimation(const RunConfig& config, const LoopStatistics& loop, Json& out) {
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

void addTracking(const RunConfig& config, const LoopStatistics& loop, Json& out) {
  const auto rms = [&](const PerJoint& sum_of_squares, int joint) {
    return std::sqrt(sum_of_squares[static_cast<std::size_t>(joint)] /
                     static_cast<double>(loop.tracking_count));
  };
  for (int i = 0; loop.tracking_count > 0 && i < config.model.joints(); ++i) {
    out["f_s_filtered_rms_rad_s2"].push_back(rms(loop.f_s_sum_of_squares, i));
    out["d_hat_rms_Nm"].push_back(rms(loop.d_hat_sum_of_squares, i));
    out["tracking_rms_rad"].push_back(rms(loop.tracking_sum_of_squares, i));
  }
}

Json recording(const Recorder& recorder) {
  return {{"ticks_written", recorder.writtenTicks()},
          {"ticks_dropped", recorder.droppedTicks()},
          {"frames_written", recorder.writtenFrames()},
          {"frames_dropped", recorder.droppedFrames()},
          {"error", recorder.error()}};
}

}  // namespace

Json summarise(const RunConfig& config, const std::vector<InputFile>& files, const LoopStatistics& loop,
               const can::Bus& bus, const can::MeasurementDecoder& decoder, const Recorder& recorder,
               const RealtimeReport* realtime) {
  Json out;
  out["patella"] = PATELLA_VERSION;
  out["backend"] = backendText(config.backend);
  out["clock"] = config.clock == ClockKind::kVirtual ? "virtual" : "monotonic";
  out["rate_Hz"] = config.loop.rate_Hz;
  out["observer"] = observerName(config.observer.kind);
  out["ticks"] = loop.ticks;
  out["inputs"] = inputs(config, files);
  if (config.backend.kind == BackendKind::kSim) {
    out["seed"] = config.rig.seed;
  }
  if (realtime != nullptr) {
    out["realtime"] = realtimeJson(*realtime);
  }
  out["timing"] = timing(loop);
  out["loop_thread"] = loopThread(loop, realtime != nullptr);
  addBuses(config, loop, bus, decoder, out);
  out["safety"] = safetyJson(config, loop, files);
  if (config.weights) {
    out["network"] = {{"rate_Hz", config.weights->rate_Hz},
                      {"compensates", config.tick.compensation == tick::CompensationSource::kNetwork}};
  }
  addEstimation(config, loop, out);
  addTracking(config, loop, out);
  out["recorder"] = recording(recorder);
  return out;
}

}  // namespace patella::app
