// patella-bench-latency: sensor frame to torque frame, watched on the bus or read from a log.
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <spdlog/fmt/fmt.h>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/socketcan_bus.hpp"
#include "drivers/clock/clock.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tools/bench/latency/frame_latency.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"

namespace {

using namespace patella;
using namespace patella::bench;

constexpr const char* kDescription =
    R"(Time from the newest sensor frame to the torque frame after it, by the kernel's stamps of both on the interface: what
a bystander sees, the loop's own figures aside. SOURCE is a CAN interface on which loop and rig are running, as can:vcan0,
or a log of candump -l or of patella run.)";

struct Arguments {
  std::string source;
  std::filesystem::path map = checkout::orInstalled(
      checkout::source() / "firmware_app/config/can/patella.toml", "/etc/patella/can/patella.toml");
  double seconds = 10.0;
  std::filesystem::path csv;
};

void watch(const std::string& interface, double seconds, FrameLatency& latency) {
  can::SocketCanBus bus(interface);
  MonotonicClock clock;
  constexpr std::int64_t kPause_ns = 2'000'000;
  std::vector<can::Frame> frames(512);
  const std::int64_t end_ns = clock.now() + static_cast<std::int64_t>(seconds * 1e9);
  while (clock.now() < end_ns) {
    clock.sleepUntil(clock.now() + kPause_ns);
    const std::size_t count = bus.receive(frames, clock.now());
    for (std::size_t i = 0; i < count; ++i) {
      latency.add(frames[i]);
    }
  }
  if (const std::uint64_t dropped = bus.statistics().receive_dropped; dropped > 0) {
    fmt::print(stderr, "patella-bench-latency: {} frames were missed\n", dropped);
  }
}

void readLog(const std::string& path, FrameLatency& latency) {
  can::CandumpReader reader(path);
  can::LogEntry entry;
  while (reader.next(entry)) {
    latency.add(entry.frame);
  }
}

void report(const FrameLatency& latency, const std::filesystem::path& csv) {
  const app::LatencyHistogram& all = latency.latency();
  if (all.count() == 0) {
    throw std::runtime_error("no torque frame after a sensor frame was seen");
  }
  fmt::print("{:<26}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}\n", "sensor to torque, µs", "count", "p50", "p99",
             "p99.9", "p99.99", "max");
  fmt::print("{:<26}{:>10}", "", all.count());
  for (const double quantile : {0.5, 0.99, 0.999, 0.9999, 1.0}) {
    fmt::print("{:>10.1f}", 1e-3 * static_cast<double>(all.quantile(quantile)));
  }
  fmt::print("\ntorque frames without a new sensor frame: {}\n", latency.unanswering());
  if (!csv.empty()) {
    std::string text = "lower_us,upper_us,count\n";
    all.forEach([&text](std::int64_t lower_ns, std::int64_t upper_ns, std::uint64_t count) {
      text += fmt::format("{:.3f},{:.3f},{}\n", 1e-3 * static_cast<double>(lower_ns),
                          1e-3 * static_cast<double>(upper_ns), count);
    });
    app::writeFile(csv, text);
  }
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app(kDescription, "patella-bench-latency");
  Arguments arguments;
  app.add_option("source", arguments.source, "can:INTERFACE, or a log")->required();
  app.add_option("--map", arguments.map, "bus map, which names the messages")->check(CLI::ExistingFile);
  app.add_option("--seconds", arguments.seconds, "to watch an interface")
      ->check(options::numberFrom(0.1, 86400.0))
      ->capture_default_str();
  app.add_option("--csv", arguments.csv, "file for the distribution");
  return patella::options::runProgram(app, argc, argv, [&] {
    FrameLatency latency(app::loadBusDescription(arguments.map));
    constexpr std::string_view kInterface = "can:";
    if (arguments.source.starts_with(kInterface)) {
      watch(arguments.source.substr(kInterface.size()), arguments.seconds, latency);
    } else {
      readLog(arguments.source, latency);
    }
    report(latency, arguments.csv);
  });
}
