// Recordings of other people's rigs through the shipped maps.
#include <algorithm>
#include <cmath>
#include <numeric>

#include <Eigen/Dense>
#include <doctest/doctest.h>

#include "core/model/planar_two_link.hpp"
#include "drivers/can/message_codec.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/convert/rig.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/convert/csv_to_log.hpp"

using namespace patella;
using namespace patella::convert;
using patella::test::ScratchFolder;

namespace {

const std::string kData = checkout::recordings();

LogReport convertShipped(const std::string& map, const std::string& recording,
                         const std::filesystem::path& log) {
  const can::Database bus = test::rigBus();
  return convertToLog(kData + "/" + recording, loadMap(test::shippedMap(map), bus), bus, log);
}

/// All values of one signal in the log.
std::vector<double> signalOf(const std::vector<can::Frame>& frames, const std::string& message,
                             const std::string& signal) {
  can::MessageDecoder decoder(test::rigBus().message(message));
  const std::size_t slot = decoder.slot(signal);
  std::vector<double> values;
  for (const can::Frame& frame : frames) {
    if (decoder.matches(frame)) {
      values.push_back(decoder.value(frame, slot));
    }
  }
  return values;
}

/// Published parameters of the double pendulum; its inertias are about the joints.
model::PlanarTwoLink publishedArm() {
  constexpr double kMass1 = 0.5234602302310271;
  constexpr double kMass2 = 0.6255677234174437;
  constexpr double kCom2 = 0.25569305436052964;
  return model::PlanarTwoLink({.mass_kg = {kMass1, kMass2},
                               .length_m = {0.2, 0.3},
                               .com_m = {0.2, kCom2},
                               .inertia_kg_m2 = {0.031887199591513114 - kMass1 * 0.2 * 0.2,
                                                 0.05086984812807257 - kMass2 * kCom2 * kCom2}});
}

/// Rest, rms in J, of work minus gained energy after the best Coulomb friction is taken away.
double energyImbalance(const std::vector<can::Frame>& frames, double hip_offset_rad, double torque_sign) {
  const model::PlanarTwoLink arm = publishedArm();
  const auto q1 = signalOf(frames, "Encoder1", "Position");
  const auto q2 = signalOf(frames, "Encoder2", "Position");
  const auto tau1 = signalOf(frames, "DriveStatus", "Torque1");
  const auto tau2 = signalOf(frames, "DriveStatus", "Torque2");
  constexpr double kStep_s = 0.002;
  constexpr std::size_t kHalfWidth = 8;  // of the difference that gives velocity, samples
  const std::size_t count = q1.size() - 2 * kHalfWidth;
  Eigen::MatrixXd friction(count, 2);
  Eigen::VectorXd lost(count);
  double work = 0.0;
  double start = 0.0;
  Eigen::RowVector2d path = Eigen::RowVector2d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t i = k + kHalfWidth;
    JointVector q(2);
    JointVector dq(2);
    q << q1[i] + hip_offset_rad, q2[i];
    dq << q1[i + kHalfWidth] - q1[k], q2[i + kHalfWidth] - q2[k];
    dq /= 2.0 * kHalfWidth * kStep_s;
    const double energy = arm.kineticEnergy(q, dq) + arm.potentialEnergy(q);
    start = k == 0 ? energy : start;
    work += kStep_s * torque_sign * (tau1[i] * dq[0] + tau2[i] * dq[1]);
    path += kStep_s * dq.cwiseAbs().transpose();
    friction.row(static_cast<Eigen::Index>(k)) = path;
    lost[static_cast<Eigen::Index>(k)] = work - (energy - start);
  }
  const Eigen::VectorXd coulomb = friction.colPivHouseholderQr().solve(lost);
  return (lost - friction * coulomb).norm() / std::sqrt(static_cast<double>(count));
}

}  // namespace

TEST_CASE("the double pendulum's map turns angles and torques so that energy balances") {
  for (const char* run : {"run_1", "run_2", "run_3"}) {
    CAPTURE(run);
    const ScratchFolder folder;
    const LogReport report =
        convertShipped("double_pendulum", "double_pendulum/" + std::string(run) + ".csv", folder / "run.log");
    CHECK(report.frames == 3 * report.instants);
    const std::vector<can::Frame> frames = test::framesOf(folder / "run.log");
    for (std::size_t i = 3; i < frames.size(); i += 3) {
      REQUIRE(frames[i].wall_ns - frames[i - 3].wall_ns == 2'000'000);
    }
    // It starts at rest, hanging.
    CHECK(signalOf(frames, "Encoder1", "Position").front() == doctest::Approx(-M_PI / 2).epsilon(1e-3));
    CHECK(std::abs(signalOf(frames, "Encoder2", "Position").front()) < 1e-3);

    const double as_mapped = energyImbalance(frames, 0.0, 1.0);
    CHECK(as_mapped < 0.1);
    CHECK(energyImbalance(frames, M_PI / 2, 1.0) > 5.0 * as_mapped);  // zero taken as horizontal
    CHECK(energyImbalance(frames, M_PI, 1.0) > 5.0 * as_mapped);      // zero taken as upright
    CHECK(energyImbalance(frames, 0.0, -1.0) > 5.0 * as_mapped);      // torque against its sign
  }
}

TEST_CASE("EMG of all five people goes through unclipped, to half a step of the converter") {
  for (const char* person : {"healthy_3", "healthy_4", "healthy_5", "impaired_1", "impaired_2"}) {
    CAPTURE(person);
    const ScratchFolder folder;
    const std::string recording = "leg_emg/" + std::string(person) + ".csv";
    const LogReport report = convertShipped("leg_emg", recording, folder / "run.log");
    CHECK(report.clipped == 0);
    CHECK(report.repeated_stamps == 0);
    const std::vector<can::Frame> frames = test::framesOf(folder / "run.log");
    const app::CsvTable table = app::CsvTable::load(kData + "/" + recording);
    REQUIRE(frames.size() == table.rows());
    const auto vastus = signalOf(frames, "Emg", "Channel3");
    const auto original = table.column("emg_vastus_medialis_mV");
    double worst = 0.0;
    for (std::size_t i = 0; i < vastus.size(); ++i) {
      worst = std::max(worst, std::abs(vastus[i] - original[i]));
    }
    CHECK(worst < 0.5 * 0.00075 + 1e-9);
  }
}

TEST_CASE("with the goniometer the knee bends as the recording says") {
  const ScratchFolder folder;
  convertShipped("leg_emg_knee", "leg_emg/healthy_3.csv", folder / "run.log");
  const std::vector<can::Frame> frames = test::framesOf(folder / "run.log");
  const auto knee = signalOf(frames, "Encoder2", "Position");
  CHECK(knee.front() == doctest::Approx(-80.6 * M_PI / 180.0).epsilon(1e-5));
  CHECK(*std::min_element(knee.begin(), knee.end()) == doctest::Approx(-82.4 * M_PI / 180.0).epsilon(1e-5));
  CHECK(*std::max_element(knee.begin(), knee.end()) == doctest::Approx(-7.1 * M_PI / 180.0).epsilon(1e-4));
}
