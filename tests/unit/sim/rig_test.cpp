#include "sim/rig.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include <doctest/doctest.h>

#include "core/model/model_description.hpp"
#include "drivers/can/crc8.hpp"
#include "tests/unit/model/chains.hpp"
#include "tests/unit/sim/rig_fixture.hpp"

using namespace patella;
using namespace patella::sim;

namespace {

const can::Message& messageOf(const can::Frame& frame) {
  const can::Message* message = rigDatabase().find(frame.id, frame.extended);
  REQUIRE(message != nullptr);
  return *message;
}

double valueOf(const can::Frame& frame, const char* signal) {
  const can::Message& message = messageOf(frame);
  REQUIRE(message.find(signal) != nullptr);
  return can::CompiledSignal(message, *message.find(signal)).decode(frame);
}

/// Newest frame of a message among `frames`.
can::Frame newest(const std::vector<can::Frame>& frames, const char* message) {
  const auto found = std::find_if(frames.rbegin(), frames.rend(), [message](const can::Frame& frame) {
    return messageOf(frame).name == message;
  });
  REQUIRE(found != frames.rend());
  return *found;
}

}  // namespace

TEST_CASE("the rig sends five frames a millisecond and buttons every ten, each with CRC and counter") {
  Rig rig(paperRig(), rigDatabase());
  const std::int64_t epoch = 123'456'789;
  std::map<std::string, std::uint64_t> count;
  for (int k = 0; k < 600; ++k) {
    rig.advance(epoch + k * kMillisecond_ns);
    const std::vector<can::Frame> frames = drain(rig);
    REQUIRE(frames.size() == (k % 10 == 0 ? 6 : 5));
    for (const can::Frame& frame : frames) {
      const std::string& name = messageOf(frame).name;
      REQUIRE(frame.length == messageOf(frame).length);
      REQUIRE(frame.monotonic_ns == epoch + k * kMillisecond_ns);
      if (name != "Truth") {
        REQUIRE(frame.data[7] == can::frameCrc(frame, 7));
        REQUIRE(frame.data[6] == count[name] % 256);
      }
      ++count[name];
    }
  }
  CHECK(count["Encoder1"] == 600);
  CHECK(count["Encoder2"] == 600);
  CHECK(count["DriveStatus"] == 600);
  CHECK(count["Emg"] == 600);
  CHECK(count["Truth"] == 600);
  CHECK(count["Operator"] == 60);
  CHECK(rig.statistics().frames_dropped == 0);
}

TEST_CASE("frames say what the plant does") {
  Rig rig(paperRig(), rigDatabase());
  CommandPen pen;
  rig.advance(0);
  for (int k = 1; k <= 300; ++k) {
    rig.accept(pen.write(0.8, -0.3));
    drain(rig);
    rig.advance(k * kMillisecond_ns);
  }
  const std::vector<can::Frame> frames = drain(rig);
  const PlantState& state = rig.plant().state();
  CHECK(state.dq.norm() > 0.1);
  CHECK(std::abs(valueOf(newest(frames, "Encoder1"), "Position") - state.q(0)) <= 0.51e-6);
  CHECK(std::abs(valueOf(newest(frames, "Encoder2"), "Position") - state.q(1)) <= 0.51e-6);
  CHECK(std::abs(valueOf(newest(frames, "Encoder2"), "Velocity") - state.dq(1)) <= 0.51e-5);
  CHECK(valueOf(newest(frames, "DriveStatus"), "Torque1") == doctest::Approx(0.8));
  CHECK(valueOf(newest(frames, "DriveStatus"), "Torque2") == doctest::Approx(-0.3));
  CHECK(valueOf(newest(frames, "DriveStatus"), "Enabled") == 1.0);
  CHECK(valueOf(newest(frames, "Emg"), "Channel1") == doctest::Approx(rig.emg().signal()[0]).epsilon(0.01));
  // Truth is the mean over the last millisecond, half a period older than the state.
  const JointVector truth = rig.plant().unknownDynamics();
  CHECK(valueOf(newest(frames, "Truth"), "Fu1") == doctest::Approx(truth(0)).epsilon(0.01));
  CHECK(valueOf(newest(frames, "Truth"), "Fu2") == doctest::Approx(truth(1)).epsilon(0.01));
  CHECK(rig.statistics().max_torque_Nm == doctest::Approx(0.8));
}

TEST_CASE("encoder noise is drawn in the same order with every compiler: the rate first") {
  RigOptions options = paperRig();
  options.encoder = {.position_noise_sd_rad = 0.01, .velocity_noise_sd_rad_s = 0.1};
  Rig rig(options, rigDatabase());
  rig.advance(0);
  const std::vector<can::Frame> frames = drain(rig);
  const PlantState& state = rig.plant().state();
  for (int joint = 0; joint < 2; ++joint) {
    Encoder encoder(options.encoder, joint, options.seed);
    const double velocity_rad_s = encoder.measureVelocity(state.dq(joint));
    const double position_rad = encoder.measurePosition(state.q(joint));
    const can::Frame frame = newest(frames, joint == 0 ? "Encoder1" : "Encoder2");
    CHECK(std::abs(valueOf(frame, "Velocity") - velocity_rad_s) <= 0.51e-5);
    CHECK(std::abs(valueOf(frame, "Position") - position_rad) <= 0.51e-6);
  }
}

TEST_CASE("the published truth is what two encoder samples and the loop's model leave unexplained") {
  RigOptions options = paperRig();
  options.hidden_effects = {{"coulomb_friction", 1, {}}};
  const model::EffectDescriptor* coulomb = model::findEffect("coulomb_friction");
  REQUIRE(coulomb != nullptr);
  for (const model::EffectParameter& parameter : coulomb->parameters) {
    options.hidden_effects[0].parameters.push_back(parameter.initial);
  }
  Rig rig(options, rigDatabase());
  const model::DynamicsModel known = model::makeModel(model::paperLeg());
  CommandPen pen;
  JointVector torque(2);
  torque << 0.6, 0.2;
  rig.advance(0);
  double worst = 0.0;
  double largest = 0.0;
  for (int k = 1; k <= 500; ++k) {
    rig.accept(pen.write(torque(0), torque(1)));
    const PlantState before = rig.plant().state();
    drain(rig);
    rig.advance(k * kMillisecond_ns);
    const PlantState& after = rig.plant().state();
    const model::ModelTerms a = known.evaluate({before.q, before.dq, torque, {}, 0.0});
    const model::ModelTerms b = known.evaluate({after.q, after.dq, torque, {}, 0.0});
    const JointVector unexplained = (after.dq - before.dq) / 1e-3 - 0.5 * (a.f + b.f) -
                                    0.5 * (a.inverse_inertia + b.inverse_inertia) * torque;
    const can::Frame truth = newest(drain(rig), "Truth");
    worst = std::max(worst, std::abs(valueOf(truth, "Fu2") - unexplained(1)));
    largest = std::max(largest, std::abs(unexplained(1)));
  }
  CHECK(largest > 1.0);
  CHECK(worst < 1e-3 * largest);
}

TEST_CASE("forged, corrupted, repeated and truncated commands are counted and do nothing") {
  Rig rig(paperRig(), rigDatabase());
  CommandPen pen;
  rig.advance(0);
  const can::Frame good = pen.write(1.0, 0.5);
  rig.accept(good);
  CHECK(rig.drive().torque()(0) == doctest::Approx(1.0));

  for (std::size_t byte = 0; byte < 8; ++byte) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      can::Frame corrupted = pen.write(2.0, 0.0);
      corrupted.data[byte] = static_cast<std::uint8_t>(corrupted.data[byte] ^ (1U << bit));
      rig.accept(corrupted);
    }
  }
  can::Frame truncated = pen.write(2.0, 0.0);
  truncated.length = 7;
  rig.accept(truncated);
  rig.accept(good);  // its counter is that of the last valid one
  CHECK(rig.statistics().commands_accepted == 1);
  CHECK(rig.statistics().commands_rejected == 66);
  CHECK(rig.drive().torque()(0) == doctest::Approx(1.0));

  // A frame of another identifier is not a command, whatever it says; nor is an error report.
  can::Frame foreign = pen.write(2.0, 0.0);
  foreign.id += 1;
  rig.accept(foreign);
  can::Frame report = pen.write(2.0, 0.0);
  report.error = true;
  rig.accept(report);
  CHECK(rig.statistics().commands_rejected == 66);

  // After lost frames the newest command is obeyed.
  rig.accept(pen.write(3.0, 0.0));
  CHECK(rig.drive().torque()(0) == doctest::Approx(3.0));
}

TEST_CASE("a controller that falls silent loses its torque after 20 ms, and the status says so") {
  Rig rig(paperRig(), rigDatabase());
  CommandPen pen;
  rig.advance(0);
  rig.accept(pen.write(1.0, 0.5));
  rig.advance(20 * kMillisecond_ns - 1);
  CHECK(rig.drive().torque().norm() > 1.0);
  rig.advance(20 * kMillisecond_ns);
  CHECK(rig.drive().torque().norm() == 0.0);
  CHECK(rig.statistics().watchdog_trips == 1);
  const can::Frame status = newest(drain(rig), "DriveStatus");
  CHECK(valueOf(status, "Torque1") == 0.0);
  CHECK(valueOf(status, "Enabled") == 0.0);
  CHECK(valueOf(status, "Fault") == static_cast<double>(DriveFault::kWatchdog));
}

TEST_CASE("one jump in time samples the same as many steps, and a command acts from its instant on") {
  RigOptions options = paperRig();
  options.encoder = {.bits_per_turn = 14, .velocity_noise_sd_rad_s = 0.01};
  Rig jump(options, rigDatabase());
  Rig steps(options, rigDatabase());
  CommandPen pen;
  const can::Frame command = pen.write(1.0, 0.5);
  for (Rig* rig : {&jump, &steps}) {
    rig->advance(0);
    rig->advance(4'300'000);
    rig->accept(command);
  }
  jump.advance(15 * kMillisecond_ns);
  for (int k = 5; k <= 15; ++k) {
    steps.advance(k * kMillisecond_ns);
  }
  const std::vector<can::Frame> a = drain(jump);
  const std::vector<can::Frame> b = drain(steps);
  REQUIRE(a.size() == b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    REQUIRE(a[i].id == b[i].id);
    REQUIRE(a[i].data == b[i].data);
    REQUIRE(a[i].monotonic_ns == b[i].monotonic_ns);
  }
}

TEST_CASE("the operator enables at the chosen time and presses reset for a tenth of a second") {
  RigOptions options = paperRig();
  options.operator_buttons = {.enable_at_s = 0.25, .reset_at_s = {0.4}};
  Rig rig(options, rigDatabase());
  for (int k = 0; k <= 60; ++k) {
    rig.advance(k * 10 * kMillisecond_ns);
    const can::Frame buttons = newest(drain(rig), "Operator");
    REQUIRE(valueOf(buttons, "Enable") == (k >= 25 ? 1.0 : 0.0));
    REQUIRE(valueOf(buttons, "Reset") == (k >= 40 && k < 50 ? 1.0 : 0.0));
  }
}

TEST_CASE("a full queue loses the newest frames and counts them") {
  RigOptions options = paperRig();
  options.queue_frames = 16;
  Rig rig(options, rigDatabase());
  rig.advance(0);
  rig.advance(10 * kMillisecond_ns);
  CHECK(drain(rig).size() == 16);
  CHECK(rig.statistics().frames_dropped == 57 - 16);
}

TEST_CASE("a rig with a slow torque loop approaches the command") {
  RigOptions options = paperRig();
  options.drive.bandwidth_Hz = 100.0;
  Rig rig(options, rigDatabase());
  CommandPen pen;
  rig.advance(0);
  rig.accept(pen.write(1.0, 0.0));
  rig.advance(kMillisecond_ns);
  CHECK(rig.drive().torque()(0) == doctest::Approx(1.0 - std::exp(-0.2 * 3.14159265)));
}

TEST_CASE("a single joint sends Encoder1 only") {
  RigOptions options;
  options.mechanism =
      model::RevoluteJointParameters{.inertia_kg_m2 = 0.3, .moment_kg_m = 0.8, .length_m = 0.4};
  options.initial_q_rad = {-1.0};
  options.publish_truth = false;
  Rig rig(options, rigDatabase());
  rig.advance(0);
  drain(rig);
  rig.advance(kMillisecond_ns);
  const std::vector<can::Frame> frames = drain(rig);
  CHECK(frames.size() == 3);
  CHECK(messageOf(frames[0]).name == "Encoder1");
  CHECK(messageOf(frames[1]).name == "DriveStatus");
  CHECK(messageOf(frames[2]).name == "Emg");
}

TEST_CASE("impossible rigs are refused by name") {
  RigOptions options = paperRig();
  options.initial_q_rad = {0.0};
  CHECK_THROWS_WITH_AS(Rig(options, rigDatabase()),
                       "rig initial_q_rad has 1 values, expected one for each of 2 joints",
                       std::invalid_argument);
  options = paperRig();
  options.operator_period_ns = 1'500'000;
  CHECK_THROWS_AS(Rig(options, rigDatabase()), std::invalid_argument);
  options = paperRig();
  options.hidden_effects = {{"no_such_effect", 0, {}}};
  CHECK_THROWS_AS(Rig(options, rigDatabase()), std::invalid_argument);
  can::Database poor = rigDatabase();
  std::erase_if(poor.messages, [](const can::Message& m) { return m.name == "Emg"; });
  CHECK_THROWS_AS(Rig(paperRig(), poor), std::invalid_argument);
}

TEST_CASE("the rig's own drives are for two joints; more need drives of their own") {
  const auto model = [&] {
    return model::makeModel(
        model::ModelDescription{.mechanism = test::RandomChains(4).draw(3), .effects = {}});
  };
  CHECK_THROWS_WITH_AS(Rig(RigOptions{}, model(), model(), rigDatabase()),
                       doctest::Contains("rig: 3 joints, expected a rig.drive_model for each"),
                       std::invalid_argument);
}
