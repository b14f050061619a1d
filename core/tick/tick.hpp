// One tick of mathematics: measurement in, command out. No device, no clock, no heap: the narrow interface
// through which the loop, the tests and the replay drive everything in core.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/control/control_law.hpp"
#include "core/control/drive_anticipation.hpp"
#include "core/control/reference_trajectory.hpp"
#include "core/emg/emg_chain.hpp"
#include "core/emg/emg_torque_map.hpp"
#include "core/measurement.hpp"
#include "core/network/attention_lstm.hpp"
#include "core/safety/drive_monitor.hpp"
#include "core/safety/emg_monitor.hpp"
#include "core/safety/encoder_monitor.hpp"
#include "core/safety/motion_monitor.hpp"
#include "core/safety/safety_limiter.hpp"
#include "core/safety/state_machine.hpp"
#include "core/safety/warning.hpp"
#include "core/tick/features.hpp"
#include "core/tick/front_end.hpp"
#include "core/tick/stage_probe.hpp"

namespace patella::tick {

/// Whose f̂_u the compensation term uses.
enum class CompensationSource { kNone, kSampler, kNetwork };

struct TickSettings {
  double encoder_period_s = 1e-3;    ///< between two encoder samples; the estimators' unit of time
  double period_s = 1e-3;            ///< between two ticks
  double velocity_cutoff_Hz = 60.0;  ///< of the velocity derived from position, where the encoder gives none
  double estimate_cutoff_Hz = 25.0;  ///< low-pass on f_s before compensation; 0: none
  /// The drives' report is a sample of a torque that changes, as a current sensor's is: the mean of two acted
  /// over the step between them. Otherwise it is the torque that was held over the step.
  bool drive_torque_sampled = false;
  CompensationSource compensation = CompensationSource::kSampler;
  /// Encoder samples from one step of the network to the next; between them its output is held. What it adds
  /// to the observer's estimate, it adds to that of every sample.
  int network_stride = 1;
  emg::EmgSettings emg;
  emg::EmgGains emg_gain_Nm{};
  control::ControlGains gains;
  control::ReferenceSettings reference;
  safety::SafetyLimits limits;
  safety::MonitorSettings monitors;
  int healthy_ticks = 50;  ///< in a row, before the loop is ready
};

struct TickInput {
  Measurement measurement;
  safety::FaultSet faults;  ///< found by drivers and loop in this tick
  bool complete = false;    ///< every bound input has been seen at least once
  double time_s = 0.0;      ///< scheduled instant since the start of the loop
};

/// Vectors have the mechanism's number of joints.
struct TickOutput {
  Command command;
  safety::State state = safety::State::kInit;
  safety::FaultSet faults;                            ///< of this tick, those found in core included
  safety::FaultSet latched;                           ///< that keep the loop stopped
  safety::Fault first_cause = safety::Fault::kCount;  ///< that stopped it; kCount for none
  std::array<safety::LimitSet, kMaxJoints> limits{};  ///< what the limiter held back in this tick
  safety::WarningSet warnings;
  bool entered_active = false;
  bool entered_stop = false;
  bool estimated = false;    ///< f_s is of a new encoder sample of this tick
  bool has_network = false;  ///< f_network is of this tick
  JointVector velocity_rad_s;
  JointVector f_s;           ///< observer, by default the finite-time sampler, rad/s²
  JointVector f_s_filtered;  ///< low-passed
  JointVector f_network;     ///< attention-LSTM, rad/s²
  JointVector d_hat_Nm;      ///< I f_s_filtered: what the model does not explain, as torque
  EmgArray activation{};
  control::ReferencePoint reference;
  control::ControlOutput control;
};

class Tick {
 public:
  /// Takes ownership. `network` may be null. Throws std::invalid_argument naming the setting, its value and
  /// what was expected, also when the network asks for a feature that the loop does not have, or gives
  /// another number of joints.
  Tick(const TickSettings& settings, model::DynamicsModel model,
       std::unique_ptr<estimation::Observer> observer, std::unique_ptr<network::AttentionLstm> network,
       const std::vector<std::string>& network_features, network::OutputKind network_output);

  /// The result stays valid until the next call.
  const TickOutput& step(const TickInput& input) noexcept PATELLA_NONBLOCKING;

  /// Prepares the next step before its measurement arrives; to be called once the command is sent.
  void prepareNext() noexcept PATELLA_NONBLOCKING;

  int joints() const noexcept { return front_.joints(); }

  /// Somebody who measures, and must outlive this.
  void probedBy(StageProbe& probe) noexcept {
    probe_ = &probe;
    front_.probedBy(probe);
  }

 private:
  void estimate(const TickInput& input) noexcept;
  void estimateNetwork(int encoder_steps) noexcept;
  void demand(const TickInput& input) noexcept;
  control::ControlOutput demandAhead(double active_s) noexcept;
  safety::FaultSet monitor(const TickInput& input) noexcept;
  const JointVector& compensated() noexcept;
  void decide(const TickInput& input) noexcept;
  void restart() noexcept;
  void forget() noexcept;
  void takeEstimates() noexcept;

  TickSettings settings_;
  FrontEnd front_;
  std::unique_ptr<network::AttentionLstm> network_;
  FeatureSelection features_;
  network::OutputKind network_output_;
  emg::EmgChain emg_;
  control::ControlLaw control_;
  control::ReferenceTrajectory reference_;
  control::DriveAnticipation anticipation_;
  safety::EncoderMonitor encoder_monitor_;
  safety::DriveMonitor drive_monitor_;
  safety::EmgMonitor emg_monitor_;
  safety::MotionMonitor motion_monitor_;
  safety::NetworkMonitor network_monitor_;
  safety::SafetyLimiter limiter_;
  safety::StateMachine states_;

  TickOutput output_;
  FeatureVector feature_values_{};
  std::vector<double> network_input_;
  JointVector network_value_;   ///< of the network's newest step
  int samples_to_network_ = 1;  ///< until its next one
  bool inconsistent_ = false;   ///< position and rate of the newest sample
  bool network_trusted_ = true;
  JointVector nothing_;  ///< zero for every joint
  JointVector last_command_Nm_;
  double active_since_s_ = 0.0;
  StageProbe* probe_ = nullptr;
};

}  // namespace patella::tick
