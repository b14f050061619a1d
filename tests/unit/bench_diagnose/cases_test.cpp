#include "tools/bench/diagnose/cases.hpp"

#include <algorithm>
#include <cmath>

#include <doctest/doctest.h>

#include "firmware_app/files/csv_table.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/recordings/recording_file.hpp"

using namespace patella::bench;

namespace {

bool sameBits(const Case& a, const Case& b) {
  const auto& x = a.run.recording;
  const auto& y = b.run.recording;
  return x.time_s == y.time_s && x.position_rad == y.position_rad && x.torque_Nm == y.torque_Nm &&
         x.activation == y.activation && a.run.stamp_s == b.run.stamp_s;
}

Case shortCase(std::uint64_t seed, Suite suite, const std::string& effect, const std::string& mechanism,
               double strength) {
  return drawCase(seed, suite,
                  {.effect = effect, .mechanism = mechanism, .motion = "multisine", .strength = strength});
}

}  // namespace

TEST_CASE("a case follows from its seed to the bit") {
  for (const Suite suite : {Suite::kNone, Suite::kSingle, Suite::kDouble, Suite::kUnknown, Suite::kDefect}) {
    const Case first = drawCase(7, suite);
    const Case again = drawCase(7, suite);
    CHECK(sameBits(first, again));
    REQUIRE(first.effects.size() == again.effects.size());
    for (std::size_t i = 0; i < first.effects.size(); ++i) {
      CHECK(first.effects[i].effect.kind == again.effects[i].effect.kind);
      CHECK(first.effects[i].effect.p == again.effects[i].effect.p);
    }
    CHECK_FALSE(sameBits(first, drawCase(8, suite)));
  }
}

TEST_CASE("where nothing is missing, the body explains the run to a hundredth of its noise") {
  // Newton and Euler's inverse against Lagrange's forward dynamics, through controller, clock and filters.
  for (const char* mechanism : {"paper_leg", "adult_leg", "light_arm", "knee", "linear_axis"}) {
    const Case drawn = drawCase(3, Suite::kNone, {.effect = {}, .mechanism = mechanism, .motion = {}});
    const Analysis analysis = analyse(drawn.rig, drawn.run);
    CHECK(analysis.raw_strength < 0.01);
    for (std::size_t j = 0; j < drawn.rig.body.joints(); ++j) {
      CHECK(analysis.noise_rms_Nm[j] > 0.5 * drawn.rig.human_Nm[j]);
      CHECK(analysis.noise_rms_Nm[j] < 10.0 * drawn.rig.human_Nm[j]);
    }
  }
}

TEST_CASE("an effect has the strength that was asked for") {
  for (const char* kind : {"coulomb_friction", "viscous_friction", "linear_stiffness", "actuator_delay",
                           "encoder_offset", "tremor"}) {
    CAPTURE(kind);
    for (const double strength : {0.7, 3.0}) {
      const Case drawn = shortCase(11, Suite::kSingle, kind, "adult_leg", strength);
      // Measured anew, from the run that is handed out.
      CHECK(analyse(drawn.rig, drawn.run).strength == doctest::Approx(strength).epsilon(0.02));
      CHECK(drawn.effects[0].strength == doctest::Approx(strength).epsilon(0.02));
    }
  }
}

TEST_CASE("what nominal parameters could be has no strength of its own") {
  for (const char* kind : {"payload", "rotor_inertia"}) {
    const Case drawn = shortCase(5, Suite::kSingle, kind, "knee", 0.0);
    CHECK(drawn.effects[0].in_span);
    CHECK(drawn.effects[0].raw_strength > 1.0);
    CHECK(drawn.effects[0].strength < 0.02);
  }
}

TEST_CASE("the strength of an offset is what the projection leaves of it") {
  // Twice the effect twice the strength, and never more than without projection.
  const Case drawn = shortCase(21, Suite::kSingle, "torque_bias", "paper_leg", 1.0);
  TrueEffect twice = drawn.effects[0].effect;
  twice.p[0] *= 2.0;
  const Run run = simulate(drawn.rig, std::span(&twice, 1));
  const Analysis analysis = analyse(drawn.rig, run);
  CHECK(analysis.strength == doctest::Approx(2.0).epsilon(0.05));
  CHECK(analysis.strength < analysis.raw_strength);
}

TEST_CASE("a recording is what a loader would hand on") {
  Case drawn = drawCase(4, Suite::kNone, {.effect = {}, .mechanism = "paper_leg", .motion = "gait"});
  Rig rig = drawn.rig;
  rig.jitter_s = 0.3e-3;
  rig.loss_probability = 0.01;
  const Run run = simulate(rig, {});
  const auto& recording = run.recording;
  CHECK(recording.joints == 2);
  CHECK(recording.rate_Hz == 1000.0);
  CHECK(recording.torque_timing == patella::diagnose::TorqueTiming::kHeld);
  CHECK(recording.rows() == static_cast<std::size_t>(std::lround(1000.0 * rig.duration_s)));
  REQUIRE(recording.segments.size() == 1);
  CHECK(recording.segments[0].end == recording.rows());
  std::size_t lost = 0;
  double worst_rad = 0.0, worst_stamp_s = 0.0;
  bool whole = true;
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    lost += std::isnan(run.raw_position_rad[0][i]) ? 1 : 0;
    worst_rad = std::max(worst_rad, std::abs(recording.position_rad[0][i] - run.encoder_rad[0][i]));
    whole = whole && std::isfinite(recording.torque_Nm[1][i]);
    worst_stamp_s = std::max(worst_stamp_s, std::abs(run.stamp_s[i] - recording.time_s[i]));
  }
  CHECK(whole);
  CHECK(worst_stamp_s <= 0.3e-3);
  CHECK(worst_stamp_s > 0.29e-3);
  CHECK(lost > recording.rows() / 200);
  CHECK(lost < recording.rows() / 50);
  // A count, and what the joint moves in the jitter.
  CHECK(worst_rad < rig.encoder_step_rad[0] + 0.3e-3 * 6.0);
  CHECK(worst_rad > 0.0);
  CHECK(recording.activation[0].size() == recording.rows());
  const auto [least, most] =
      std::minmax_element(recording.activation[0].begin(), recording.activation[0].end());
  CHECK(*least >= 0.0);
  CHECK(*most > 0.2);
}

TEST_CASE("a case on disk reads back as the case in memory") {
  const patella::test::ScratchFolder folder;
  const Case drawn = drawCase(6, Suite::kNone, {.effect = {}, .mechanism = "adult_leg", .motion = "sine"});
  writeCsv(drawn.run, folder.path() / "case.csv");
  const auto loaded = patella::diagnose::loadRecording(
      folder.path() / "case.csv",
      {.joints = 2, .columns = {}, .dbc = {}, .bus_map = {}, .torque_timing = {}});
  CHECK(loaded.rate_Hz == doctest::Approx(1000.0).epsilon(2e-3));
  CHECK(loaded.torque_timing == patella::diagnose::TorqueTiming::kHeld);
  REQUIRE(loaded.rows() > 0.99 * static_cast<double>(drawn.run.recording.rows()));
  CHECK_FALSE(loaded.activation[1].empty());
  const std::vector<double>& command = drawn.run.command_Nm[0];
  // A recording begins at zero, the file a tick and the jitter of its first stamp later.
  const double begun_s = patella::app::CsvTable::load(folder.path() / "case.csv").column("t_s")[0];
  double square_rad = 0.0, square_Nm = 0.0;
  std::size_t count = 0;
  for (std::size_t i = 1000; i + 1000 < loaded.rows(); ++i, ++count) {
    // The file's clock is one tick ahead.
    const double time_s = begun_s + loaded.time_s[i];
    const auto k = static_cast<std::size_t>(std::lround(time_s / kTick_s)) - 1;
    const double rest_s = time_s - kTick_s * static_cast<double>(k + 1);
    const double rate = (drawn.run.encoder_rad[0][k + 1] - drawn.run.encoder_rad[0][k]) / kTick_s;
    const double error_rad = loaded.position_rad[0][i] - drawn.run.encoder_rad[0][k] - rate * rest_s;
    // A held torque may have been taken from the tick before or after.
    const auto [least, most] = std::minmax({command[k - 1], command[k], command[k + 1]});
    const double torque_Nm = loaded.torque_Nm[0][i];
    const double error_Nm = torque_Nm - std::clamp(torque_Nm, least, most);
    square_rad += error_rad * error_rad;
    square_Nm += error_Nm * error_Nm;
  }
  CHECK(std::sqrt(square_rad / static_cast<double>(count)) < drawn.rig.encoder_step_rad[0] + 3e-4);
  CHECK(std::sqrt(square_Nm / static_cast<double>(count)) < drawn.rig.torque_noise_Nm[0]);
}

TEST_CASE("the model handed over is wrong by up to a tenth, and complete otherwise") {
  const Case drawn = drawCase(9, Suite::kNone, {.effect = {}, .mechanism = "adult_leg", .motion = {}});
  const auto& model = std::get<patella::model::PlanarTwoLinkParameters>(drawn.nominal.mechanism);
  for (std::size_t i = 0; i < 2; ++i) {
    const double ratio = model.mass_kg[i] / drawn.rig.body.mass_kg[i];
    CHECK(std::abs(ratio - 1.0) <= 0.1);
    CHECK(ratio != 1.0);
    CHECK(model.length_m[i] == drawn.rig.body.length_m[i]);
  }
  REQUIRE(drawn.nominal.effects.size() == 2);
  CHECK(drawn.nominal.effects[1].kind == "viscous_friction");
  CHECK(drawn.nominal.effects[1].joint == 1);
}

TEST_CASE("every kind can be drawn and leaves the robot under control") {
  for (const KindInfo& info : allKinds()) {
    CAPTURE(info.name);
    const Suite suite = info.in_library ? Suite::kSingle : info.defect ? Suite::kDefect : Suite::kUnknown;
    const Case drawn = drawCase(
        31, suite, {.effect = std::string(info.name), .mechanism = {}, .motion = {}, .strength = 1.0});
    CHECK(drawn.run.stable);
    CHECK(drawn.effects[0].effect.kind == info.kind);
    // Less than was asked for only where the effect is at its limit.
    CHECK((drawn.effects[0].in_span || drawn.effects[0].strength > 0.44));
  }
}

TEST_CASE("a robot that runs away, though it lacks nothing, is drawn anew") {
  const Case drawn = drawCase(1007000172, Suite::kNone,
                              {.effect = {}, .mechanism = "chain", .motion = "multisine", .joints = 7});
  CHECK(drawn.run.stable);
  CHECK(drawn.effects.empty());
  CHECK(drawn.rig.body.joints() == 7);
}

TEST_CASE("a wish that cannot be met is refused by name") {
  CHECK_THROWS_WITH_AS(drawCase(1, Suite::kSingle, {.effect = "cubic_drag", .mechanism = {}, .motion = {}}),
                       doctest::Contains("cubic_drag"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(drawCase(1, Suite::kNone, {.effect = {}, .mechanism = "crane", .motion = {}}),
                       doctest::Contains("crane"), std::invalid_argument);
  CHECK_THROWS_WITH_AS(drawCase(1, Suite::kNone, {.effect = {}, .mechanism = {}, .motion = "jump"}),
                       doctest::Contains("jump"), std::invalid_argument);
}
