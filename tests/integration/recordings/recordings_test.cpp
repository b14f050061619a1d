// Results of people's EMG and a real arm in the whole loop. Bounds are set from what
// was measured, stated at each, with room for filters and calibration to be chosen otherwise but not for a
// wrong sign, unit, delay or model.
#include <algorithm>
#include <cmath>
#include <map>
#include <string>

#include <doctest/doctest.h>

#include "firmware_app/files/csv_table.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/studies/recordings/emg_study.hpp"
#include "tools/studies/recordings/pendulum_study.hpp"

using namespace patella::study;

namespace {

/// A fresh folder that goes with its runs.
class RunFolders {
 public:
  const Folders& get() const noexcept { return folders_; }

 private:
  patella::test::ScratchFolder out_;
  Folders folders_{
      .data = patella::checkout::recordings(), .project = patella::checkout::source(), .out = out_.path()};
};

double medianLead(const EmgStudy& study) {
  Samples leads;
  for (const Onset& onset : study.onsets) {
    leads.push_back(onset.lead_s());
  }
  return patella::offline::median(leads);
}

}  // namespace

TEST_CASE("torque from five people's EMG goes with their knee and comes before it") {
  const RunFolders folders;
  // Measured correlations 0.83, 0.79, 0.71, 0.50, 0.84, leads 210 to 456 ms, of a simulated knee 0.63 to
  // 0.87.
  const std::map<std::string, int> sign_in_file{
      {"healthy_3", 1}, {"healthy_4", 1}, {"healthy_5", -1}, {"impaired_1", 1}, {"impaired_2", -1}};
  for (const std::string& person : recordedPeople()) {
    CAPTURE(person);
    const EmgStudy study = studyEmg(folders.get(), person);
    const bool healthy = person.starts_with("healthy");
    CHECK(study.goniometer_sign == sign_in_file.at(person));
    CHECK(study.angle.correlation > (healthy ? 0.65 : 0.4));
    CHECK(study.angle.lag_s > 0.1);
    CHECK(study.angle.lag_s < 0.6);
    CHECK(study.simulated_angle_correlation > (healthy ? 0.75 : 0.5));
    CHECK(study.flexion == (person == "impaired_2"));
    CHECK(study.onsets.size() == (healthy ? 4U : 2U));
    if (!study.flexion) {
      // Measured medians of 59 to 95 ms, after a filter that takes 37 ms of the muscle's own lead. The
      // goniometer knows onsets to 20 ms.
      CHECK(medianLead(study) > 0.02);
      CHECK(medianLead(study) < 0.2);
    }
  }
}

TEST_CASE("the loop measures the recorded EMG sample by sample") {
  const RunFolders folders;
  studyEmg(folders.get(), "impaired_2");
  const auto recorded = patella::app::CsvTable::load(folders.get().data / "leg_emg/impaired_2.csv");
  const auto ticks =
      patella::app::CsvTable::load(folders.get().out / "impaired_2/loop/ticks.csv", {.allow_missing = true});
  REQUIRE(ticks.rows() == recorded.rows());
  const auto expected = recorded.column("emg_semitendinosus_mV");
  const auto measured = ticks.column("emg4_mV");
  double worst_mV = 0.0;
  for (std::size_t k = 0; k < expected.size(); ++k) {
    worst_mV = std::max(worst_mV, std::abs(measured[k] - expected[k]));
  }
  CHECK(worst_mV > 0.0);
  CHECK(worst_mV < 0.00038);  // half a step of the bus
}

TEST_CASE("the sampler finds in a real arm what inverse dynamics find offline") {
  const RunFolders folders;
  constexpr double kPublishedCoulomb_Nm[] = {0.16, 0.12};
  for (const std::string& run : recordedPendulumRuns()) {
    const PendulumStudy study = studyPendulum(folders.get(), run);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      CAPTURE(run);
      CAPTURE(joint);
      const JointComparison& c = study.joint[joint];
      // Measured 0.946 to 0.978, and 0.21 to 0.33 of the RMS; without the delay's correction 0.62 to 0.84.
      CHECK(c.correlation_aligned > 0.93);
      CHECK(c.rms_difference_aligned_Nm < 0.38 * c.rms_offline_Nm);
      CHECK(c.rms_difference_aligned_Nm < 0.1);
      CHECK(c.correlation_delayed < 0.9);
      CHECK(c.rms_loop_Nm == doctest::Approx(c.rms_offline_Nm).epsilon(0.08));
      // Measured 38 to 42 ms where the filters promise 40.8.
      CHECK(std::abs(c.measured_delay_s - study.delay_s) < 0.005);
      // The torque against motion is the published Coulomb friction and up to as much again that grows with
      // load.
      CHECK(c.friction_loop_Nm == doctest::Approx(c.friction_offline_Nm).epsilon(0.12));
      CHECK(c.friction_loop_Nm > 0.9 * kPublishedCoulomb_Nm[joint]);
      CHECK(c.friction_loop_Nm < 2.1 * kPublishedCoulomb_Nm[joint]);
    }
  }
}
