// Promises of the judgement of conventions: each changes states as its words say, the right one explains a
// recording that was made with it, and none is found in a recording that the model explains.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "tests/unit/diagnose/chain_recordings.hpp"
#include "tests/unit/diagnose/swinging_arm.hpp"
#include "tools/diagnose/fit/point_body.hpp"
#include "tools/diagnose/thresholds.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

// The same arm, driven at its shoulder only. The second torque's zero is off.
Recording halfDriven(double bias_Nm) {
  constexpr int kSteps = 20;  // a row
  constexpr double kRate_Hz = 200.0, kStep_s = 1.0 / (kRate_Hz * kSteps), kFriction_Nms_rad = 0.005;
  const model::DynamicsModel dynamics = model::makeModel(arm());
  const model::Mechanism& body = dynamics.mechanism();
  Recording recording;
  recording.name = "acrobot.csv";
  recording.rate_Hz = kRate_Hz;
  recording.joints = 2;
  recording.torque_timing = TorqueTiming::kSampled;
  JointVector q(2), dq = JointVector::Zero(2), torque = JointVector::Zero(2);
  q << -0.5 * kPi, 1.2;
  for (int step = 0; step < 2400 * kSteps; ++step) {
    const double t = step * kStep_s;
    torque[0] = 0.6 * std::sin(2.0 * kPi * 0.7 * t) + 0.5 * std::sin(2.0 * kPi * 1.1 * t);
    if (step % kSteps == 0) {
      recording.time_s.push_back(t);
      for (int joint = 0; joint < 2; ++joint) {
        recording.position_rad[static_cast<std::size_t>(joint)].push_back(q[joint]);
        recording.torque_Nm[static_cast<std::size_t>(joint)].push_back(torque[joint] + joint * bias_Nm);
      }
    }
    const JointVector free = torque - body.coriolis(q, dq) * dq - body.gravity(q) - kFriction_Nms_rad * dq;
    dq += kStep_s * JointVector(Eigen::MatrixXd(body.inertia(q)).inverse() * free);
    q += kStep_s * dq;
  }
  recording.segments = {{.first = 0, .end = recording.rows()}};
  return recording;
}

bool isAmong(const std::vector<ReadAs>& found, ConventionKind kind, int joint, double number = 0.0,
             double within = 1e300) {
  return std::any_of(found.begin(), found.end(), [&](const ReadAs& one) {
    return one.convention.kind == kind && one.convention.joint == joint &&
           std::abs(one.convention.number - number) < within;
  });
}

std::vector<double> later(const std::vector<double>& values, std::size_t rows) {
  std::vector<double> shifted(values.size(), values.front());
  std::copy(values.begin(), values.end() - static_cast<std::ptrdiff_t>(rows),
            shifted.begin() + static_cast<std::ptrdiff_t>(rows));
  return shifted;
}

std::vector<double> earlier(std::vector<double> values, std::size_t rows) {
  std::reverse(values.begin(), values.end());
  values = later(values, rows);
  std::reverse(values.begin(), values.end());
  return values;
}

}  // namespace

TEST_CASE("a recording in the model's own conventions has no better ones") {
  CHECK(wrongIn(swinging()).empty());
}

TEST_CASE("a motor's inertia that the model lacks is no wrong convention") {
  CHECK(wrongIn(swinging({.rotor_kg_m2 = 0.03})).empty());
  CHECK(wrongIn(swinging({.rotor_kg_m2 = 0.1})).empty());
  CHECK(wrongIn(swinging({.rotor_kg_m2 = 0.03, .second_line = 0.0})).empty());
  CHECK(wrongIn(swinging({.rotor_kg_m2 = 0.1, .second_line = 0.0})).empty());
}

TEST_CASE("a bias on a joint that swings freely is no torque in another unit") {
  for (const double bias_Nm : {0.1, 0.2, 0.4, 0.8}) {
    CAPTURE(bias_Nm);
    CHECK(wrongIn(halfDriven(bias_Nm)).empty());
  }
}

TEST_CASE(
    "where the model leaves no more than models of machines do, a convention has to take most of it away") {
  const auto early = [](std::size_t rows) {
    Recording recording = swinging();
    recording.torque_Nm[1] = earlier(recording.torque_Nm[1], rows);
    return recording;
  };
  const auto leftOfSecond = [](const Recording& recording) {
    return Reader(Dataset(std::span(&recording, 1), kCoarse), arm()).asGiven().error[1];
  };
  const Recording little = early(6), more = early(10);
  CHECK(leftOfSecond(little) > convention::kFloor);
  CHECK(wrongIn(little).empty());
  CHECK(leftOfSecond(more) < convention::kAsMachines);
  CHECK(isAmong(wrongIn(more), ConventionKind::kTorqueShift, 1, -0.05, 0.02));
}

TEST_CASE(
    "a torque that comes late is no drive's, so that it has to be explained better than by effects only") {
  Recording recording = swinging();
  recording.torque_Nm[1] = later(recording.torque_Nm[1], 6);
  CHECK(isAmong(wrongIn(recording), ConventionKind::kTorqueShift, 1, 0.03, 0.02));
}

namespace {

// A leg sits down and stands up. Dry friction holds both joints in between, and their drives work up to it
// before the next motion starts. By minimum jerk, as Flash and Hogan have it.
Recording sittingDown(const model::ModelDescription& leg) {
  constexpr double kRate_Hz = 100.0, kMove_s = 1.5, kPause_s = 1.0, kWorkUp_s = 0.3;
  constexpr std::array kFriction_Nm{9.0, 6.0}, kSeated_rad{-1.3, -1.5}, kUp_rad{-0.3, -0.2};
  model::DynamicsModel dynamics = model::makeModel(leg);
  Recording recording;
  recording.name = "sitting.csv";
  recording.rate_Hz = kRate_Hz;
  recording.joints = 2;
  recording.torque_timing = TorqueTiming::kSampled;
  for (int i = 0; i < static_cast<int>(40.0 * kRate_Hz); ++i) {
    const double t = i / kRate_Hz, within = std::fmod(t, kMove_s + kPause_s);
    const double direction = static_cast<int>(t / (kMove_s + kPause_s)) % 2 == 0 ? 1.0 : -1.0;
    const double x = std::min(1.0, within / kMove_s), left = 1.0 - x;
    model::EffectInput state;
    state.q.resize(2);
    state.dq.resize(2);
    state.torque_Nm.setZero(2);
    JointVector ddq(2);
    for (std::size_t j = 0; j < 2; ++j) {
      const auto joint = static_cast<Eigen::Index>(j);
      const double way = direction * (kUp_rad[j] - kSeated_rad[j]);
      state.q[joint] =
          (direction > 0.0 ? kSeated_rad[j] : kUp_rad[j]) + way * x * x * x * (10.0 - 15.0 * x + 6.0 * x * x);
      state.dq[joint] = way * 30.0 * x * x * left * left / kMove_s;
      ddq[joint] = way * 60.0 * x * left * (1.0 - 2.0 * x) / (kMove_s * kMove_s);
    }
    const JointVector torque = dynamics.inverseDynamics(state, ddq);
    const double remains_s = kMove_s + kPause_s - within;
    const double rubs = direction * (remains_s < kWorkUp_s ? 2.0 * remains_s / kWorkUp_s - 1.0 : 1.0);
    recording.time_s.push_back(t);
    for (std::size_t j = 0; j < 2; ++j) {
      const auto joint = static_cast<Eigen::Index>(j);
      recording.position_rad[j].push_back(state.q[joint]);
      recording.torque_Nm[j].push_back(torque[joint] + kFriction_Nm[j] * rubs);
    }
  }
  recording.segments = {{.first = 0, .end = recording.rows()}};
  return recording;
}

}  // namespace

TEST_CASE("friction that holds joints between two poses is no torque that comes early") {
  const model::ModelDescription leg{.mechanism = model::PlanarTwoLinkParameters{.mass_kg = {8.5, 4.2},
                                                                                .length_m = {0.43, 0.42},
                                                                                .com_m = {0.19, 0.24},
                                                                                .inertia_kg_m2 = {0.16, 0.09},
                                                                                .gravity_m_s2 = 9.81},
                                    .effects = {}};
  const Recording recording = sittingDown(leg);
  // All rows together say so.
  CHECK(isAmong(wrongIn(recording, leg), ConventionKind::kTorqueShift, kAllJoints));
  CHECK_NOTHROW(requireConventions(recording, leg));
}

TEST_CASE("a payload on the last link is no unit of its torque") {
  const model::ModelDescription arm = uprightChain(3, 1.0);
  const Recording loaded = moved(withBody(arm, {.mass_kg = 3.0, .at_m = {0.3, 0.0, 0.0}}), 12.0, 0.001);
  CHECK(wrongIn(loaded, arm).empty());
}

TEST_CASE("a sign, a unit, a zero and a clock of one joint are named with joint and size") {
  Recording recording = swinging();
  SUBCASE("sign of a torque: friction that drives gives it away") {
    map(recording.torque_Nm[0], [](double tau) { return -tau; });
    CHECK(isAmong(wrongIn(recording), ConventionKind::kTorqueSign, 0));
  }
  SUBCASE("sign of a position that counts from hanging") {
    map(recording.position_rad[0], [](double q) { return -kPi - q; });
    CHECK(isAmong(wrongIn(recording), ConventionKind::kPositionSign, 0));
  }
  SUBCASE("degrees that count from hanging") {
    map(recording.position_rad[0], [](double q) { return (q + 0.5 * kPi) * 180.0 / kPi - 0.5 * kPi; });
    CHECK(isAmong(wrongIn(recording), ConventionKind::kPositionUnit, 0));
  }
  SUBCASE("torque before the gear") {
    map(recording.torque_Nm[1], [](double tau) { return tau / 6.0; });
    CHECK(isAmong(wrongIn(recording), ConventionKind::kTorqueUnit, 1, 1.0 / 6.0, 0.06));
  }
  SUBCASE("torque behind the gear") {
    map(recording.torque_Nm[1], [](double tau) { return 30.0 * tau; });
    CHECK(isAmong(wrongIn(recording), ConventionKind::kTorqueUnit, 1, 30.0, 15.0));
  }
  SUBCASE("gravity's sign, which is the zero of the first angle off by half a turn") {
    map(recording.position_rad[0], [](double q) { return q + kPi; });
    const std::vector<ReadAs> found = wrongIn(recording);
    CHECK(std::any_of(found.begin(), found.end(), [](const ReadAs& one) {
      return one.convention.kind == ConventionKind::kZero && one.convention.joint == 0 &&
             one.convention.mistake.find("gravity is of the other sign") != std::string::npos;
    }));
  }
  SUBCASE("a zero off by some angle") {
    map(recording.position_rad[1], [](double q) { return q - 0.6; });
    CHECK(isAmong(wrongIn(recording), ConventionKind::kZero, 1, 0.6, 0.1));
  }
  SUBCASE("a torque that comes too late") {
    recording.torque_Nm[1] = later(recording.torque_Nm[1], 20);
    CHECK(isAmong(wrongIn(recording), ConventionKind::kTorqueShift, 1, 0.1, 0.02));
  }
}

TEST_CASE("friction that comes up over the way since a reversal is rubbing, and no torque that comes late") {
  constexpr double kWay_rad = 0.02, kLevel_Nm = 0.5;
  Recording recording = swinging();
  double bristle = 0.0;
  for (std::size_t i = 1; i < recording.rows(); ++i) {
    const double step_rad = recording.position_rad[1][i] - recording.position_rad[1][i - 1];
    bristle += (step_rad - std::abs(step_rad) * bristle) / kWay_rad;
    recording.torque_Nm[1][i] += kLevel_Nm * bristle;
  }
  CHECK(Reader(Dataset(std::span(&recording, 1), kCoarse), arm()).asGiven().error[1] < 0.05);
  CHECK(wrongIn(recording).empty());
}

TEST_CASE("effects on a joint that a torque's shift does not explain say nothing against it") {
  constexpr double kSpring_Nm_rad = 1.5;
  Recording recording = swinging();
  for (std::size_t i = 0; i < recording.rows(); ++i) {
    recording.torque_Nm[0][i] += kSpring_Nm_rad * (recording.position_rad[0][i] + 0.5 * kPi);
  }
  CHECK(wrongIn(recording).empty());
  recording.torque_Nm[1] = later(recording.torque_Nm[1], 8);
  CHECK(isAmong(wrongIn(recording), ConventionKind::kTorqueShift, 1, 0.04, 0.02));
}

TEST_CASE("a torque that comes early by no more than drives act late is no reading of its own") {
  const auto tells = [](std::size_t rows) {
    Recording recording = swinging();
    recording.torque_Nm[1] = earlier(recording.torque_Nm[1], rows);
    Reader reader(Dataset(std::span(&recording, 1), kCoarse), arm());
    return isAmong(readings(reader, reader.asGiven(), columnNames(arm())), ConventionKind::kTorqueShift, 1,
                   -static_cast<double>(rows) / 200.0, 0.01);
  };
  CHECK_FALSE(tells(5));
  CHECK(tells(8));
}

TEST_CASE("a torque that comes too early may be that of a late drive, and is where the model declares one") {
  constexpr std::ptrdiff_t kRows = 9;
  constexpr double kEarly_s = kRows / 200.0;
  Recording recording = swinging();
  std::vector<double>& torque = recording.torque_Nm[1];
  std::rotate(torque.begin(), torque.begin() + kRows, torque.end());
  std::fill(torque.end() - kRows, torque.end(), torque[torque.size() - kRows - 1]);
  const std::vector<ReadAs> found = wrongIn(recording);
  REQUIRE(isAmong(found, ConventionKind::kTorqueShift, 1, -kEarly_s, 0.02));
  CHECK(found.front().convention.mistake.find("declare actuator_delay") != std::string::npos);

  model::ModelDescription late = arm();
  late.effects.push_back({.kind = "actuator_delay", .joint = 1, .parameters = {kEarly_s}});
  CHECK(wrongIn(recording, late).empty());
}

TEST_CASE("a number at the end of its range is none: the best would lie beyond") {
  Recording recording = swinging();
  recording.torque_Nm[1] = later(recording.torque_Nm[1], 52);  // 0.26 s
  Reader reader(Dataset(std::span(&recording, 1), kCoarse), arm());
  for (const ReadAs& one : readings(reader, reader.asGiven(), columnNames(arm()))) {
    if (one.convention.kind == ConventionKind::kTorqueShift) {
      CAPTURE(one.convention.joint);
      CHECK(std::abs(one.convention.number) < convention::kFarthestShift_s - 2e-3);
    }
  }
}

TEST_CASE("joints that were exchanged are named by what was") {
  Recording recording = swinging();
  std::swap(recording.torque_Nm[0], recording.torque_Nm[1]);
  CHECK(isAmong(wrongIn(recording), ConventionKind::kTorquesExchanged, -1));
  std::swap(recording.position_rad[0], recording.position_rad[1]);
  CHECK(isAmong(wrongIn(recording), ConventionKind::kJointsExchanged, -1));
}

TEST_CASE("a joint that is plainly wrong does not hide behind one whose torque is a hundred times as large") {
  Recording recording = swinging();
  const Reader right(Dataset(std::span(&recording, 1), kCoarse), arm());
  map(recording.torque_Nm[1], [](double tau) { return -tau; });
  const Reader wrong(Dataset(std::span(&recording, 1), kCoarse), arm());
  CHECK(wrong.asGiven().error[0] < 1.5 * right.asGiven().error[0] + convention::kFloor);
  CHECK(wrong.asGiven().error[1] > 1.0);
  const std::vector<ReadAs> found = wrongIn(recording);
  CHECK(isAmong(found, ConventionKind::kTorqueSign, 1));
  CHECK_FALSE(isAmong(found, ConventionKind::kTorqueSign, -1));
}

TEST_CASE("a joint without torque is judged by its load") {
  Recording recording = swinging();
  map(recording.torque_Nm[1], [](double) { return 0.0; });
  const Reader reader(Dataset(std::span(&recording, 1), kCoarse), arm());
  const Reading given = reader.asGiven();
  CHECK(std::isfinite(given.error[1]));
  CHECK(given.error[1] <= 1.5);
  CHECK(reader.load_Nm(1) > 0.1);
}

TEST_CASE("a torque that is made larger leaves no smaller share of the load") {
  const Recording recording = swinging();
  Reader reader(Dataset(std::span(&recording, 1), kCoarse), arm());
  const Reading given = reader.asGiven();
  for (const Convention& unit : torqueUnits(columnNames(arm()), 1)) {
    CAPTURE(unit.change);
    const Reading read = reader.read(unit);
    CHECK(read.load_Nm[1] <= (1.0 + 1e-12) * reader.load_Nm(1));
    CHECK((unit.number > 1.0 || read.error[1] > given.error[1]));
  }
}

TEST_CASE("a joint at rest says nothing of itself") {
  Recording recording = swinging();
  map(recording.position_rad[1], [](double) { return 0.2; });
  const Reader reader(Dataset(std::span(&recording, 1), kCoarse), arm());
  CHECK(reader.asGiven().error[1] == 0.0);
}

TEST_CASE("the one that went wrong is told with what it explains, and all that are as good are handed over") {
  Recording recording = swinging();
  map(recording.torque_Nm[1], [](double tau) { return -tau; });
  try {
    requireConventions(recording, arm());
    FAIL("was believed");
  } catch (const WrongConvention& wrong) {
    const std::string words = wrong.what();
    CHECK(words.find("arm.csv: looks like tau2_Nm is of the other sign (−tau2)") == 0);
    CHECK(words.find(" % of joint 2's torque, as given ") != std::string::npos);
    CHECK_FALSE(wrong.conventions().empty());
  }
}
