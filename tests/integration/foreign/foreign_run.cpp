// Sets up slaves of another author by our own SDO client, runs the loop on them, and writes what went over
// the bus.
//
//   foreign_run CONFIGURATION LOG PROGRAM ARGUMENT...
#include <array>
#include <atomic>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include "drivers/can/candump_log.hpp"
#include "drivers/canopen/node_setup.hpp"
#include "drivers/gpio/pins.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/loop/loop.hpp"
#include "firmware_app/recorder/run_account.hpp"
#include "tests/integration/foreign/pipe_bus.hpp"

namespace {

using namespace patella;

constexpr double kRun_s = 4.0;
constexpr int kEnableAtTick = 100;
int g_failures = 0;  // NOLINT: a program of one purpose

void check(bool holds, const std::string& what) {
  std::printf("%s  %s\n", holds ? "ok   " : "FAILS", what.c_str());
  g_failures += holds ? 0 : 1;
}

void writeLog(const std::vector<can::Frame>& frames, const char* path) {
  std::ofstream file(path);
  std::array<char, can::kMaxLogLine> line{};
  for (const can::Frame& frame : frames) {
    file.write(line.data(), static_cast<std::streamsize>(can::formatLogLine(line, frame, "pipe0")));
  }
}

/// Counts ticks, so that the operator presses enable in one of them.
class Operator final : public app::LoopSink {
 public:
  Operator(app::RunAccount& account, test::PipeBus& bus) : account_(account), bus_(bus) {}
  void begin() noexcept override { account_.begin(); }
  void end() noexcept override { account_.end(); }
  void frame(const can::Frame& frame) noexcept PATELLA_NONBLOCKING override { account_.frame(frame); }
  void tick(const app::TickReport& report) noexcept PATELLA_NONBLOCKING override {
    account_.tick(report);
    bus_.operate(++ticks_ > kEnableAtTick);
  }
  void tickEnded(bool overrun, std::uint32_t missed) noexcept override {
    account_.tickEnded(overrun, missed);
  }

 private:
  app::RunAccount& account_;
  test::PipeBus& bus_;
  int ticks_ = 0;
};

void run(const app::RunConfig& config, test::PipeBus& bus) {
  MonotonicClock clock;
  for (const canopen::NodeIdentity& node :
       canopen::setUpNodes(bus, clock, config.bus.canopen, 1.0 / config.loop.rate_Hz)) {
    std::printf("%s\n", canopen::identityText(node).c_str());
    check(node.vendor == 0xCAFE && node.name == "Patella rig drive", "identity as the sheet has it");
  }
  const auto tick = app::makeTick(config);
  can::MeasurementDecoder decoder = app::makeDecoder(config);
  can::CommandEncoder encoder = app::makeEncoder(config);
  gpio::SimulatedPins pins;
  app::RunAccount account({.warmup_ticks = config.warmup_ticks});
  Operator sink(account, bus);
  app::LoopOptions options = config.loop;
  bus.operate(false);
  app::Loop loop({.options = options,
                  .clock = clock,
                  .bus = bus,
                  .pins = pins,
                  .decoder = decoder,
                  .encoder = encoder,
                  .tick = *tick,
                  .sink = sink,
                  .canopen = config.bus.canopen});
  const std::atomic<bool> never{false};
  loop.run(never);
  const app::LoopStatistics& s = account.statistics();
  check(s.final_state == safety::State::kActive, "both drives came in, and the loop stayed active: state " +
                                                     std::string(safety::stateName(s.final_state)));
  for (int i = 0; i < safety::kFaultCount; ++i) {
    const auto fault = static_cast<safety::Fault>(i);
    check(!s.latched.has(fault), "no " + std::string(safety::faultName(fault)));
  }
  check(s.max_torque_Nm > 5.0, "torque flowed: " + std::to_string(s.max_torque_Nm) + " N·m at most");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr, "foreign_run CONFIGURATION LOG PROGRAM ARGUMENT...\n");
    return 2;
  }
  try {
    app::CommandLine line;
    line.config = argv[1];
    line.duration_s = kRun_s;
    const app::RunConfig config = app::loadRunConfig(line);
    test::PipeBus bus({argv + 3, argv + argc}, config.bus.database);
    try {
      run(config, bus);
    } catch (const std::exception& error) {
      check(false, error.what());
    }
    check(bus.close() == 0, "the slaves' program ended by itself");
    writeLog(bus.log(), argv[2]);
  } catch (const std::exception& error) {
    check(false, error.what());
  }
  return g_failures == 0 ? 0 : 1;
}
