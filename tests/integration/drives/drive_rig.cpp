#include "tests/integration/drives/drive_rig.hpp"

#include <atomic>
#include <cmath>
#include <stdexcept>

#include "drivers/canopen/node_setup.hpp"
#include "drivers/gpio/pins.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/drive_ranges.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::test {
namespace {

const std::filesystem::path kConfig = checkout::source() / "firmware_app/config";

void replace(std::string& text, const std::string& from, const std::string& to) {
  std::size_t at = text.find(from);
  if (at == std::string::npos) {
    throw std::logic_error("the demonstration has no '" + from + "'");
  }
  for (; at != std::string::npos; at = text.find(from, at + to.size())) {
    text.replace(at, from.size(), to);
  }
}

std::string model(bool mit, int id) {
  std::string text = "[[rig.drive_model]]\nkind = \"";
  text += mit ? "mit" : "odrive";
  text += "\"\nid = " + std::to_string(id) + "\ntorque_limit_Nm = 144\n";
  if (mit) {
    text += "master_id = 0\nposition_range_rad = 12.5\nvelocity_range_rad_s = 8\ntorque_range_Nm = 144\n";
  }
  return text;
}

std::string nodeModel(int node) {
  return "[[rig.drive_model]]\nkind = \"cia402\"\nid = " + std::to_string(node) +
         "\ntorque_limit_Nm = 144\nrated_torque_Nm = 0.5\ngear = 100\ncounts_per_turn = 16384\n"
         "watchdog_s = 0.004\n";
}

/// Of two maps, what concerns joint 1 from the first and joint 2 from the second, by the line.
std::string mixedMap(const std::string& mit, const std::string& odrive) {
  const auto line_of = [](const std::string& text, std::size_t at) {
    const std::size_t begin = text.rfind('\n', at) + 1;
    return text.substr(begin, text.find('\n', at) - begin + 1);
  };
  std::string text = mit;
  for (const std::string input : {"position_rad", "velocity_rad_s", "drive_torque_Nm",
                                  "drive_temperature_degC", "drive_fault", "drive_error"}) {
    const std::string name = "name = \"" + input + ".2\"";
    const std::string mine = line_of(text, text.find(name));
    text.replace(text.find(mine), mine.size(), line_of(odrive, odrive.find(name)));
  }
  const std::string enabled = line_of(odrive, odrive.find("drive_enabled.2"));
  text.insert(text.find("  { name = \"emg_mV.1\""), enabled);
  text.resize(text.rfind("[[command]]"));
  return text + odrive.substr(odrive.rfind("[[command]]"));
}

/// Messages of two files that differ in name and identifier, in one.
void writeMixedDbc(const std::filesystem::path& path) {
  std::string mit = app::readFile(kConfig / "can/mit_mode.dbc");
  const std::string odrive = app::readFile(kConfig / "can/odrive_cansimple.dbc");
  const std::size_t messages = odrive.find("BO_ 33 ");
  const std::size_t shared = odrive.find("BO_ 160 ");
  mit.insert(mit.find("BO_ 160 "), odrive.substr(messages, shared - messages));
  const std::size_t types = odrive.find("SIG_VALTYPE_ 41 ");
  mit += odrive.substr(types, odrive.find("SIG_VALTYPE_ 2016 ") - types);
  replace(mit, "BU_: Controller Motors Rig", "BU_: Controller Motors Axes Rig");
  app::writeFile(path, mit);
}

}  // namespace

app::RunConfig driveConfiguration(Drives drives, double duration_s, const ScratchFolder& folder) {
  const bool two_buses = drives == Drives::kTwoBuses;
  std::string text = app::readFile(kConfig / (two_buses ? "two_buses.toml" : "adult.toml"));
  if (!two_buses) {
    replace(text, "\nweights = ", "\n# ");  // a network is not the subject
  }
  replace(text, "\"models/", "\"" + (kConfig / "models/").string());
  const std::filesystem::path map = folder.path() / "map.toml";
  const std::filesystem::path mit_dbc = kConfig / "can/mit_mode.dbc";
  const std::filesystem::path odrive_dbc = kConfig / "can/odrive_cansimple.dbc";
  std::string mit = app::readFile(kConfig / "can/mit_mode.toml");
  std::string odrive = app::readFile(kConfig / "can/odrive_cansimple.toml");
  std::string nodes = app::readFile(kConfig / (two_buses ? "can/two_buses.toml" : "can/cia402.toml"));
  replace(nodes, "\"cia402.", "\"" + (kConfig / "can/cia402.").string());
  replace(odrive, "\"odrive_cansimple.dbc\"", "\"" + odrive_dbc.string() + "\"");
  if (drives == Drives::kBuiltIn) {
    replace(text, "\"can/patella.toml\"", "\"" + (kConfig / "can/patella.toml").string() + "\"");
  } else if (two_buses) {
    replace(text, "\"can/two_buses.toml\"", "\"" + map.string() + "\"");
  } else {
    replace(text, "\"can/patella.toml\"", "\"" + map.string() + "\"");
    const bool first_mit = drives != Drives::kOdrive;
    const bool second_mit = drives == Drives::kMit;
    const std::string models =
        drives == Drives::kCia402 ? nodeModel(1) + nodeModel(2) : model(first_mit, 1) + model(second_mit, 2);
    replace(text, "[rig.emg]", models + "[rig.emg]");
  }
  if (drives == Drives::kMixed) {
    writeMixedDbc(folder.path() / "mixed.dbc");
    replace(mit, "\"mit_mode.dbc\"", "\"" + (folder.path() / "mixed.dbc").string() + "\"");
    mit = mixedMap(mit, odrive);
  } else {
    replace(mit, "\"mit_mode.dbc\"", "\"" + mit_dbc.string() + "\"");
  }
  app::writeFile(map, drives == Drives::kOdrive                ? odrive
                      : drives == Drives::kCia402 || two_buses ? nodes
                                                               : mit + mitRanges());
  const std::filesystem::path path = folder.path() / "run.toml";
  app::writeFile(path, text);
  app::CommandLine line;
  line.config = path;
  line.clock = "virtual";
  line.duration_s = duration_s;
  return app::loadRunConfig(line);
}

double DriveRun::tracking_rad(std::size_t joint) const {
  return std::sqrt(loop.tracking_sum_of_squares[joint] / static_cast<double>(loop.tracking_count));
}

namespace {

bool anyTorque(const sim::Rig& rig) {
  for (std::size_t joint = 0; joint < rig.fieldDrives().size(); ++joint) {
    if (rig.fieldDrives()[joint].torque() != 0.0) {
      return true;
    }
  }
  return false;
}

/// Lives on without a loop.
double torqueLeft_s(sim::Rig& rig, std::int64_t from_ns) {
  constexpr std::int64_t kLook_ns = 100'000;
  constexpr std::int64_t kLongest_ns = 1'000'000'000;
  std::int64_t after_ns = 0;
  while (after_ns < kLongest_ns && anyTorque(rig)) {
    after_ns += kLook_ns;
    rig.advance(from_ns + after_ns);
  }
  return 1e-9 * static_cast<double>(after_ns);
}

}  // namespace

DriveRun runDrives(const app::RunConfig& config, const std::function<void(WatchedBus&)>& prepare) {
  VirtualClock clock;
  const auto rig = app::makeRig(config);
  const auto tick = app::makeTick(config);
  can::MeasurementDecoder decoder = app::makeDecoder(config);
  can::CommandEncoder encoder = app::makeEncoder(config);
  gpio::SimulatedPins pins;
  WatchedBus bus(*rig, clock, pins);
  bus.seen.reserve(64);
  if (prepare) {
    prepare(bus);
  }
  app::RunAccount account({.warmup_ticks = config.warmup_ticks});
  app::Loop loop({.options = config.loop,
                  .clock = clock,
                  .bus = bus,
                  .pins = pins,
                  .decoder = decoder,
                  .encoder = encoder,
                  .tick = *tick,
                  .sink = account,
                  .canopen = config.bus.canopen});
  if (config.bus.canopen.any()) {
    canopen::setUpNodes(bus, clock, config.bus.canopen, 1.0 / config.loop.rate_Hz);
    bus.tick = -1;
  }
  const std::atomic<bool> stop{false};
  loop.run(stop);
  DriveRun run;
  run.torque_left_s = torqueLeft_s(*rig, clock.now());
  run.loop = account.statistics();
  run.bus = bus.statistics();
  run.seen = bus.seen;
  run.rig = rig->statistics();
  for (std::size_t message = 0; message < decoder.messageCount(); ++message) {
    const can::MessageStatistics& s = decoder.statistics(message);
    run.unused_frames += s.corrupt + s.repeated + s.reordered + s.out_of_range + s.late;
  }
  for (std::size_t joint = 0; joint < rig->fieldDrives().size(); ++joint) {
    run.commands.push_back(rig->fieldDrives()[joint].commands());
    run.enabled.push_back(rig->fieldDrives()[joint].enabled());
  }
  run.line_up_in_run = bus.line_up;
  run.line_up = pins.driveEnable();
  return run;
}

}  // namespace patella::test
