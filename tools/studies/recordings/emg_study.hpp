// A person's recorded EMG through the loop, against the motion of the knee that it was recorded with.
#pragma once

#include <string>
#include <vector>

#include "core/emg/emg_chain.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "tools/signals/signals.hpp"
#include "tools/studies/recordings/loop_run.hpp"

namespace patella::study {

using offline::CorrelationPeak;
using offline::Samples;

/// Onsets of one movement, s.
struct Onset {
  double emg_s = 0.0;
  double motion_s = 0.0;
  double lead_s() const noexcept { return motion_s - emg_s; }
};

struct EmgStudy {
  std::string person;
  double rate_Hz = 1000.0;
  int goniometer_sign = 1;  ///< that makes extension positive: the one with the larger correlation
  bool flexion = false;     ///< the effort that dominates is the flexors'
  Samples torque_Nm;        ///< of the loop's EMG at the knee, extension positive
  Samples knee_rad;         ///< recorded, extension positive
  Samples simulated_knee_rad;
  CorrelationPeak angle;                     ///< EMG torque leads the recorded angle
  CorrelationPeak velocity;                  ///< EMG torque leads the recorded rate
  double simulated_angle_correlation = 0.0;  ///< simulated with recorded angle
  std::vector<Onset> onsets;
};

/// Calibration of EMG, from the recording itself: each channel's rest is the 10th percentile of
/// its envelope; full effort is the 98th percentile of the strongest channel, for all alike, so that a silent
/// muscle does not have its noise turned into torque.
void calibrate(emg::EmgSettings& settings, const app::CsvTable& recording);

/// Runs the loop and compares. Throws as runRecording(), and std::runtime_error when the loop stops.
EmgStudy studyEmg(const Folders& folders, const std::string& person);

/// Names of the recordings.
const std::vector<std::string>& recordedPeople();

}  // namespace patella::study
