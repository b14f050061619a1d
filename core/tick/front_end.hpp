// From an encoder sample to what the loop knows of the motion: velocity, known terms, the observer's
// estimate, and the quantities that a network may be fed with. The loop and the training of networks share
// it.
#pragma once

#include <memory>
#include <vector>

#include "core/emg/emg_torque_map.hpp"
#include "core/estimation/observer.hpp"
#include "core/estimation/velocity_estimator.hpp"
#include "core/measurement.hpp"
#include "core/model/dynamics_model.hpp"
#include "core/signal/biquad.hpp"
#include "core/tick/features.hpp"
#include "core/tick/stage_probe.hpp"

namespace patella::tick {

struct FrontEndSettings {
  double encoder_period_s = 1e-3;    ///< between two encoder samples; the estimators' unit of time
  double velocity_cutoff_Hz = 60.0;  ///< of the velocity derived from position, where the encoder gives none
  double estimate_cutoff_Hz = 25.0;  ///< low-pass on f_s; 0: none
  /// The drives' report is a sample of a torque that changes, as a current sensor's is: the mean of two acted
  /// over the step between them. Otherwise it is the torque that was held over the step.
  bool drive_torque_sampled = false;
  emg::EmgGains emg_gain_Nm{};
};

/// Vectors have the mechanism's number of joints.
struct Estimates {
  JointVector f_s;           ///< observer, rad/s²
  JointVector f_s_filtered;  ///< low-passed
  JointVector d_hat_Nm;      ///< I f_s_filtered: what the model does not explain, as torque
};

class FrontEnd {
 public:
  /// Takes ownership. Throws std::invalid_argument naming the setting, its value and what was expected.
  FrontEnd(const FrontEndSettings& settings, model::DynamicsModel model,
           std::unique_ptr<estimation::Observer> observer);

  /// Takes a sample with encoder_steps > 0. Where the drives report no torque, `commanded_Nm` is taken as
  /// applied. False for a first sample, and the first after restart() before any: it only begins the
  /// estimates.
  bool update(const Measurement& measurement, const EmgArray& activation, const JointVector& commanded_Nm,
              double time_s) noexcept PATELLA_NONBLOCKING;
  /// Everything with a memory starts over at the present sample, with nothing known of f_u.
  void restart() noexcept PATELLA_NONBLOCKING;

  /// Somebody who measures, and must outlive this.
  void probedBy(StageProbe& probe) noexcept { probe_ = &probe; }

  bool started() const noexcept { return started_; }
  int joints() const noexcept { return model_.joints(); }
  const model::DynamicsModel& model() const noexcept { return model_; }
  /// Position, velocity, applied torque, activation and time of the newest sample.
  const model::EffectInput& state() const noexcept { return state_; }
  const model::ModelTerms& terms() const noexcept { return terms_; }
  const Estimates& estimates() const noexcept { return estimates_; }
  /// EMG's torque by the configured gains, N·m.
  JointVector emgTorque(const EmgArray& activation) const noexcept { return emg_torque_.torque(activation); }
  /// The observer's input of the newest sample.
  estimation::ObserverInput observerInput() const noexcept;
  void features(FeatureVector& values) const noexcept PATELLA_NONBLOCKING;

 private:
  FrontEndSettings settings_;
  model::DynamicsModel model_;
  std::unique_ptr<estimation::Observer> observer_;
  estimation::VelocityEstimator velocity_;
  std::vector<signal::BiquadCascade> filter_;
  emg::EmgTorqueMap emg_torque_;

  model::EffectInput state_;
  model::ModelTerms terms_;
  Estimates estimates_;
  std::array<JointVector, kRiseTimes> settled_Nm_;  ///< d_hat_Nm behind the low-passes of kRiseTimes_s
  JointVector previous_torque_Nm_;                  ///< applied at the sample before
  double step_s_;
  StageProbe* probe_ = nullptr;
  bool has_velocity_ = false;  ///< state_.dq was measured
  bool started_ = false;       ///< a first sample has been seen
};

}  // namespace patella::tick
