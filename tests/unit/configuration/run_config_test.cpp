// Configuration of a run, by file and by command line. tests/integration/malformed has malformed input.
#include "firmware_app/configuration/run_config.hpp"

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/model/presets.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "firmware_app/recorder/input_files.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/configuration/changed_config.hpp"
#include "tests/unit/model/chains.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella::app;
using namespace patella::test;

namespace {

CommandLine shipped() {
  CommandLine line;
  line.config = kShipped / "adult.toml";
  return line;
}

}  // namespace

TEST_CASE("a script of faults names encoders and drives of the joints that there are") {
  const patella::test::ScratchFolder folder;
  const auto channelOf = [&](const char* kind, const char* channel, const char* configuration) {
    writeFile(folder / "faults.toml", std::string("[[fault]]\nkind = \"") + kind +
                                          "\"\ntime_s = 1\nchannel = \"" + channel + "\"\n" +
                                          (std::string(kind) == "encoder_jump" ? "offset_rad = 0.5\n" : ""));
    CommandLine line;
    line.config = kShipped / configuration;
    line.faults = folder / "faults.toml";
    return loadRunConfig(line).faults.at(0).channel;
  };
  CHECK(channelOf("encoder_jump", "encoder4", "two_legs.toml") == 3);
  CHECK(channelOf("drive_not_following", "drive3", "two_legs.toml") == 2);
  CHECK(channelOf("encoder_jump", "encoder2", "adult.toml") == 1);
  CHECK_THROWS_WITH_AS(channelOf("encoder_jump", "encoder3", "adult.toml"),
                       doctest::Contains("value 'encoder3', expected one of 'encoder1', 'encoder2', 'all'"),
                       FileError);
}

TEST_CASE("backends by name") {
  CHECK(parseBackend("sim").kind == BackendKind::kSim);
  const Backend can = parseBackend("can:vcan0");
  CHECK(can.kind == BackendKind::kCan);
  CHECK(can.target == "vcan0");
  const Backend replay = parseBackend("replay:runs/a:b/frames.log");
  CHECK(replay.kind == BackendKind::kReplay);
  CHECK(replay.target == "runs/a:b/frames.log");
  for (const char* text : {"", "Sim", "can", "can:", "replay:", "usb:0"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parseBackend(text), std::invalid_argument);
  }
}

TEST_CASE(
    "a log that a configuration names is in the folder of the file, one of the command line where it says") {
  const patella::test::ScratchFolder folder;
  const auto logOf = [&](const std::string& configured, const std::optional<std::string>& backend = {}) {
    const std::string text =
        changed(readFile(kShipped / "adult.toml"), {"\"sim\"", "\"" + configured + "\""});
    writeFile(folder / "run.toml", withShippedPaths(text));
    CommandLine line;
    line.config = folder / "run.toml";
    line.backend = backend;
    return loadRunConfig(line).backend.target;
  };
  CHECK(logOf("replay:logs/../frames.log") == (folder / "frames.log").string());
  CHECK(logOf("replay:/tmp/frames.log") == "/tmp/frames.log");
  CHECK(logOf("can:can0") == "can0");
  CHECK(logOf("replay:frames.log", "replay:others/frames.log") == "others/frames.log");
  CHECK(logOf("replay:frames.log", "sim").empty());
}

TEST_CASE("the command line wins over the file") {
  CommandLine line = shipped();
  line.clock = "virtual";
  line.duration_s = 2.0;
  line.rate_Hz = 500.0;
  line.seed = 42;
  const RunConfig config = loadRunConfig(line);
  CHECK(config.clock == ClockKind::kVirtual);
  CHECK(config.loop.max_ticks == 1000);
  CHECK(config.tick.period_s == 0.002);
  CHECK(config.rig.seed == 42);
  CHECK(loadRunConfig(shipped()).rig.seed == 1);
}

TEST_CASE("a log is played on the virtual clock whatever the file says, a bus never is") {
  CommandLine replay = shipped();
  replay.backend = "replay:frames.log";
  CHECK(loadRunConfig(replay).clock == ClockKind::kVirtual);
  CommandLine bus = shipped();
  bus.backend = "can:can0";
  CHECK(loadRunConfig(bus).clock == ClockKind::kMonotonic);
  bus.clock = "virtual";
  CHECK_THROWS_AS(loadRunConfig(bus), std::invalid_argument);
}

TEST_CASE("drives on a real bus are watched") {
  const patella::test::ScratchFolder folder;
  const std::string text = withShippedPaths(readFile(kShipped / "adult.toml"));
  writeFile(folder / "unwatched.toml", text + "\n[safety.drive]\nmonitor = false\n");
  CommandLine line;
  line.config = folder / "unwatched.toml";
  line.backend = "replay:frames.log";
  CHECK_FALSE(loadRunConfig(line).tick.monitors.drive.enabled);
  line.backend = "can:can0";
  CHECK_THROWS_WITH_AS(
      loadRunConfig(line),
      "safety.drive.monitor = false with backend can:can0, expected true: it finds drives that "
      "do not follow or exceed the limit",
      std::invalid_argument);
}

TEST_CASE("a loop on a real bus is told which lines it goes without") {
  CommandLine line = shipped();
  CHECK(missingLines(loadRunConfig(line)).empty());
  line.backend = "can:can0";
  RunConfig config = loadRunConfig(line);
  CHECK(missingLines(config).size() == 2);
  config.gpio.emplace();
  config.gpio->drive_enable_line = 2;
  const std::vector<std::string> missing = missingLines(config);
  REQUIRE(missing.size() == 1);
  CHECK(missing.front().starts_with("gpio.emergency_stop_line is not wired"));
}

TEST_CASE("another model of the loop leaves the rig what it is, and the other way round") {
  const auto models = patella::checkout::source() / "firmware_app/config/models";
  const RunConfig plain = loadRunConfig(shipped());
  REQUIRE(plain.model.effects.size() == 2);
  REQUIRE(plain.rig_model.effects.size() == 4);

  CommandLine loop = shipped();
  loop.model = models / "physical.toml";
  const RunConfig told = loadRunConfig(loop);
  CHECK(told.model_path == *loop.model);
  CHECK(told.rig_model_path == plain.rig_model_path);
  CHECK(told.rig_model.effects.size() == 4);

  CommandLine rig = shipped();
  rig.rig_model = models / "adult.toml";
  const RunConfig real = loadRunConfig(rig);
  CHECK(real.model_path == plain.model_path);
  CHECK(real.rig_model_path == *rig.rig_model);
  CHECK(real.rig_model.effects.size() == 2);

  CommandLine misfit = shipped();
  misfit.rig_model = patella::checkout::source() / "tools/diagnose/maps/emps_inertia.toml";
  CHECK_THROWS_AS(loadRunConfig(misfit), std::invalid_argument);
}

TEST_CASE("a reference from a file replaces the configuration's") {
  using patella::control::MultisineMotion;
  using patella::control::SinusoidMotion;
  CommandLine line = shipped();
  REQUIRE(std::holds_alternative<SinusoidMotion>(loadRunConfig(line).tick.reference.motion[0]));
  line.reference = patella::checkout::source() / "firmware_app/config/references/unseen.toml";
  const RunConfig config = loadRunConfig(line);
  CHECK(config.reference_path == *line.reference);
  const auto* waves = std::get_if<MultisineMotion>(&config.tick.reference.motion[0]);
  REQUIRE(waves != nullptr);
  REQUIRE(waves->components.size() == 4);
  CHECK(waves->offset_rad == -1.25);
  CHECK(waves->components[1].frequency_Hz == 0.41);
  CHECK(waves->components[1].amplitude_rad == 0.2);
  CHECK(waves->components[1].phase_rad == patella::control::schroederPhase_rad(1, 4));
  line.reference = *line.reference / "missing.toml";
  CHECK_THROWS_AS(loadRunConfig(line), FileError);
}

TEST_CASE(
    "a run takes a chain, with settings for each of its joints, and refuses a force filter on it by name") {
  const patella::test::ScratchFolder folder;
  const auto with = [&](const patella::model::MechanismDescription& chain, const std::string& config) {
    saveModel({.mechanism = chain, .effects = {}}, folder / "chain.toml");
    CommandLine line = shipped();
    line.config = config;
    line.model = folder / "chain.toml";
    line.rig_model = patella::checkout::source() / "firmware_app/config/models/adult.toml";
    return loadRunConfig(line);
  };
  const std::string adult = shipped().config.string();
  const auto leg = patella::test::asChain(patella::model::adultLeg().parameters);
  CHECK(with(leg, adult).model.joints() == 2);
  CHECK_THROWS_WITH_AS(
      with(patella::test::RandomChains(2).draw(3), adult),
      doctest::Contains("key 'control.stiffness_Nm_rad': 2 elements, expected an array of 3"), FileError);

  std::string text = readFile(adult);
  const auto replace = [&](const std::string& before, const std::string& after) {
    const std::size_t at = text.find(before);
    REQUIRE(at != std::string::npos);
    text.replace(at, before.size(), after);
  };
  replace("observer = \"implicit_sampler\"\nk_d_1_s = 300\n",
          "observer = \"kalman_force\"\nposition_noise_rad = 1e-4\ntorque_noise_Nm = 0.01\n"
          "disturbance_density = [5, 5]\ndisturbance_limit = 50\n");
  text.erase(text.find("delta_rad_s2"), text.find("velocity_cutoff_Hz") - text.find("delta_rad_s2"));
  writeFile(folder / "force.toml", withShippedPaths(text));
  for (const patella::model::MechanismDescription& chain :
       {patella::model::MechanismDescription(leg),
        patella::model::MechanismDescription(patella::model::ChainGroupParameters{{leg}})}) {
    CHECK_THROWS_WITH_AS(
        with(chain, folder / "force.toml"),
        doctest::Contains("value 'kalman_force' with a serial_chain, expected one of the others"), FileError);
  }
}

namespace {

/// The demonstration with one place of its configuration and one of its bus map changed; what is said of it.
std::string refusal(const Change& run, const Change& map = {"# ", "# "}) {
  const std::string absolute =
      changed(readFile(kShipped / "can/patella.toml"),
              {"dbc = \"../../../", "dbc = \"" + patella::checkout::source().string() + "/"});
  return refusalOf(changedEverywhere(adultBesideItsMap(), run), changedEverywhere(absolute, map));
}

}  // namespace

TEST_CASE("URDFs of the models and the log of the rig's EMG are inputs of a run, and are found changed") {
  const patella::test::ScratchFolder folder;
  const auto robot = [](double mass_kg) {
    std::string text = "<robot name=\"r\"><link name=\"base\"/>";
    std::string before = "base";
    for (const std::string name : {"thigh", "shank"}) {
      text += "<link name=\"" + name + "\"><inertial><mass value=\"" + std::to_string(mass_kg) +
              "\"/><inertia ixx=\"1\" iyy=\"1\" izz=\"1\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial></link>"
              "<joint name=\"" +
              name + "_joint\" type=\"continuous\"><parent link=\"" + before + "\"/><child link=\"" + name +
              "\"/><axis xyz=\"0 0 1\"/></joint>";
      before = name;
    }
    return text + "</robot>";
  };
  const auto model = [](const std::string& urdf) {
    return "[mechanism]\nkind = \"serial_chain\"\ngravity_m_s2 = [0, -9.81, 0]\n[[mechanism.chain]]\nurdf = "
           "\"" +
           urdf + "\"\nbase = \"base\"\ntip = \"shank\"\n";
  };
  writeFile(folder / "loop.urdf", robot(3.0));
  writeFile(folder / "rig.urdf", robot(4.0));
  writeFile(folder / "loop.toml", model("loop.urdf"));
  writeFile(folder / "rig.toml", model("rig.urdf"));
  writeFile(folder / "emg.log", "");
  CommandLine line = shipped();
  line.model = folder / "loop.toml";
  line.rig_model = folder / "rig.toml";
  RunConfig config = loadRunConfig(line);
  config.rig.emg_log = folder / "emg.log";
  const std::vector<InputFile> files = inputFiles(config);
  CHECK(changedFiles(files).empty());
  writeFile(folder / "loop.urdf", robot(3.5));
  writeFile(folder / "rig.urdf", robot(4.5));
  writeFile(folder / "emg.log", "(1.0) can0 130#00\n");
  CHECK(changedFiles(files) == std::vector<std::string>{"model_urdf_1", "rig_model_urdf_1", "rig_emg_log"});
  line.rig_model.reset();
  CHECK(loadRunConfig(line).rig_model_urdfs.empty());  // the configuration's names none
}

TEST_CASE("EMG that assists has its electrodes on the bus") {
  CHECK(refusal({"emg = 0.3", "emg = 0.3"}).empty());
  CHECK(says(refusal({"emg = 0.3", "emg = 0.3"}, {"{ name = \"emg_mV.4", "# {"}),
             "key 'control.emg': value 0.3, expected 0, or an input emg_mV.4, to which emg.gain2_Nm gives "
             "torque, of "));
  CHECK(refusal({"gain2_Nm = [0, 0, 8, -8]", "gain2_Nm = [0, 0, 8, 0]"}, {"{ name = \"emg_mV.4", "# {"})
            .empty());
  CHECK(refusal({"emg = 0.3", "emg = 0"}, {"{ name = \"emg_mV.4", "# {"}).empty());
  CHECK(says(refusal({"emg = 0.3", "emg = -1"}, {"{ name = \"emg_mV.", "# {"}),
             "key 'control.emg': value -1, expected 0, or an input emg_mV of "));
}

TEST_CASE("positions within the safety range are plausible on the bus") {
  const std::string lower = "position_min_rad = -6.3";
  const std::string upper = "position_max_rad = 6.3";
  CHECK(refusal({"emg = 0.3", "emg = 0"}, {lower, "position_min_rad = -2.2"}).empty());
  CHECK(says(refusal({"emg = 0.3", "emg = 0"}, {lower, "position_min_rad = -2.1"}),
             "key 'safety.q_min_rad': value -2.2, expected at least checks.position_min_rad of "));
  CHECK(refusal({"emg = 0.3", "emg = 0"}, {upper, "position_max_rad = 0.2"}).empty());
  CHECK(says(refusal({"emg = 0.3", "emg = 0"}, {upper, "position_max_rad = 0.15"}),
             "key 'safety.q_max_rad': value 0.2, expected at most checks.position_max_rad of "));
}
