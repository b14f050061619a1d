#include "tools/diagnose/checks/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/integration/diagnose_bad/spoilt_rigs.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/recordings/recording_file.hpp"

using namespace patella;
using namespace patella::diagnose;
using namespace patella::test;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::string refusal(const Recording& recording, const model::ModelDescription& model) {
  return messageOf<std::invalid_argument>([&] { requirePlausible(std::span(&recording, 1), model); });
}

// Delay of the recorded torque after the acting one, in rows.
void delay(std::vector<double>& values, std::size_t rows) {
  std::copy_backward(values.begin(), values.end() - static_cast<std::ptrdiff_t>(rows), values.end());
}

bool says(const std::string& message, const std::string& phrase) {
  return message.find(phrase) != std::string::npos;
}

}  // namespace

TEST_CASE("recordings of rigs that lack something belong to their models") {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    const bench::Case drawn = bench::drawCase(seed, static_cast<bench::Suite>(seed % 4));
    CAPTURE(drawn.run.recording.name);
    CHECK_NOTHROW(requirePlausible(std::span(&drawn.run.recording, 1), drawn.nominal));
  }
}

TEST_CASE("strong effects that the model lacks are no mistake of the recording") {
  for (const char* mechanism : {"knee", "light_arm", "linear_axis"}) {
    CAPTURE(mechanism);
    const SpoiltRig rig = rubbingRig(mechanism, 3, 40.0);
    CHECK_NOTHROW(requirePlausible(std::array{rig.record()}, rig.model()));
  }
}

TEST_CASE("signals that are no signals are refused with their place") {
  const SpoiltRig rig = rubbingRig("knee", 1);
  Recording recording = rig.record();
  SUBCASE("not a number") {
    recording.position_rad[0][5000] = std::numeric_limits<double>::quiet_NaN();
    CHECK(says(refusal(recording, rig.model()), "run.csv: position of joint 1 is nan at 5"));
    CHECK_THROWS_AS(diagnosed(std::span(&recording, 1), rig.model()), std::invalid_argument);
  }
  SUBCASE("infinite") {
    recording.torque_Nm[0][7] = std::numeric_limits<double>::infinity();
    CHECK(says(refusal(recording, rig.model()), "torque of joint 1 is inf at"));
  }
  SUBCASE("of another length") {
    recording.torque_Nm[0].pop_back();
    CHECK(says(refusal(recording, rig.model()), "torque of joint 1 has"));
  }
  SUBCASE("three samples") {
    recording.time_s.resize(3);
    recording.position_rad[0].resize(3);
    recording.torque_Nm[0].resize(3);
    for (auto& channel : recording.activation) {
      channel.clear();
    }
    recording.segments = {{.first = 0, .end = 3}};
    CHECK(says(refusal(recording, rig.model()), "3 rows, expected at least 200"));
  }
  SUBCASE("stretches that are all too short") {
    recording.segments = {{.first = 0, .end = 900}, {.first = 1000, .end = 2500}};
    CHECK(says(refusal(recording, rig.model()), "takes 1.5 s, expected at least 2 s"));
    recording.warnings = {"the file is cut off, and was read up to 2.5 s"};
    CHECK(says(refusal(recording, rig.model()), "expected at least 2 s; the file is cut off"));
  }
  SUBCASE("time that runs back") {
    std::swap(recording.time_s[100], recording.time_s[101]);
    CHECK(says(refusal(recording, rig.model()), "expected it to increase"));
  }
  SUBCASE("of other joints than the model") {
    CHECK(says(refusal(recording, rubbingRig("light_arm", 1).model()), "it has 1 joints, expected 2"));
  }
}

TEST_CASE("a file whose time runs backwards is refused by its line") {
  const ScratchFolder folder;
  std::string text = "t_s,q1_rad,tau1_Nm\n";
  for (int i = 400; i > 0; --i) {
    text += std::to_string(0.01 * i) + ",0.1,0.2\n";
  }
  app::writeFile(folder / "run.csv", text);
  const std::string message =
      messageOf<app::FileError>([&] { loadRecording(folder / "run.csv", {.joints = 1}); });
  CHECK(says(message, "run.csv:3: time 3.99 s comes after 4 s"));
}

TEST_CASE("angles that no joint reaches are taken for degrees") {
  const SpoiltRig rig = rubbingRig("light_arm", 2);
  Recording recording = rig.record();
  scale(recording.position_rad[1], 1.0 / kDegree);
  const std::string message = refusal(recording, rig.model());
  CHECK(says(message, "run.csv: q2_rad is "));
  CHECK(says(message, "expected within ±4π rad"));
}

TEST_CASE("units, signs and columns that are wrong are named") {
  struct Spoilt {
    const char* mechanism;
    const char* named;
    std::function<void(Recording&)> spoil;
  };
  const std::vector<Spoilt> all{
      {"light_arm", "q2_rad is converted from degrees twice",
       [](Recording& r) { scale(r.position_rad[1], kDegree); }},
      {"light_arm", "tau2_Nm is too large by 180/π",
       [](Recording& r) { scale(r.torque_Nm[1], 1.0 / kDegree); }},
      {"light_arm", "tau1_Nm is too small by 180/π", [](Recording& r) { scale(r.torque_Nm[0], kDegree); }},
      {"light_arm", "q2_rad is of the other sign", [](Recording& r) { scale(r.position_rad[1], -1.0); }},
      {"light_arm", "tau2_Nm is of the other sign", [](Recording& r) { scale(r.torque_Nm[1], -1.0); }},
      {"light_arm", "q1_rad and q2_rad are swapped",
       [](Recording& r) { std::swap(r.position_rad[0], r.position_rad[1]); }},
      {"light_arm", "tau1_Nm and tau2_Nm are swapped",
       [](Recording& r) { std::swap(r.torque_Nm[0], r.torque_Nm[1]); }},
      {"light_arm", "q1_rad and tau1_Nm are swapped",
       [](Recording& r) { std::swap(r.torque_Nm[0], r.position_rad[0]); }},
      {"light_arm", "the zero of q1_rad is off by -1.57 rad (-90°)",
       [](Recording& r) {
         for (double& q : r.position_rad[0]) {
           q += 0.5 * std::numbers::pi;
         }
       }},
      {"light_arm", "the zero of q2_rad is off by 0.7",
       [](Recording& r) {
         for (double& q : r.position_rad[1]) {
           q -= 0.7;
         }
       }},
      {"light_arm", "ms too late", [](Recording& r) { delay(r.torque_Nm[1], 80); }},
      {"light_arm", "tau2_Nm is measured before a gear of",
       [](Recording& r) { scale(r.torque_Nm[1], 1.0 / 6.0); }},
      {"light_arm", "gravity is of the other sign",
       [](Recording& r) {
         for (double& q : r.position_rad[0]) {
           q += std::numbers::pi;
         }
       }},
      {"light_arm", "q1_rad is of the other sign",
       [](Recording& r) {
         for (double& q : r.position_rad[0]) {
           q = -std::numbers::pi - q;
         }
       }},
      {"knee", "q1_rad is converted from degrees twice",
       [](Recording& r) { scale(r.position_rad[0], kDegree); }},
      {"knee", "tau1_Nm is too small by 180/π", [](Recording& r) { scale(r.torque_Nm[0], kDegree); }},
      {"knee", "tau1_Nm is of the other sign", [](Recording& r) { scale(r.torque_Nm[0], -1.0); }},
      // A force of the other sign and a position of the other sign are the same to a mass on a rail.
      {"linear_axis", "tau1_N is of the other sign", [](Recording& r) { scale(r.torque_Nm[0], -1.0); }},
      {"linear_axis", "q1_m is in millimetres", [](Recording& r) { scale(r.position_rad[0], 1000.0); }},
  };
  for (const Spoilt& spoilt : all) {
    const SpoiltRig rig = rubbingRig(spoilt.mechanism, 2);
    Recording recording = rig.record();
    REQUIRE_NOTHROW(requirePlausible(std::span(&recording, 1), rig.model()));
    spoilt.spoil(recording);
    const std::string message = refusal(recording, rig.model());
    const std::string named = spoilt.named;
    CAPTURE(named);
    CAPTURE(message);
    CHECK(says(message, "run.csv: looks like "));
    CHECK(says(message, named));
    CHECK(says(message, "'s torque, as given "));
  }
}
