// Recordings as regression sees them: smoothed states, and everything that is compared put through one
// low-pass and decimated alike, so that no filter stands on one side of the equation only.
#pragma once

#include <array>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "core/model/dynamics_model.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Values of all joints in the analysis band: the rows of joint 1, then those of joint 2.
using Column = Eigen::VectorXd;

inline constexpr int kFilterOrder = 4;  ///< of every low-pass

struct DatasetOptions {
  double smoothing_Hz = 40.0;         ///< zero-phase, on positions and torques before they are differentiated
  double evaluation_rate_Hz = 500.0;  ///< at most; effects are evaluated at this rate
  double band_Hz = 14.0;              ///< zero-phase, on torques and columns
  bool asked_part = false;            ///< tell what the motion asked for from the rest, which takes a while
};

/// Slow enough for noise and vibration to count little, fast enough for inertia to show: for what is judged
/// before anything is fitted.
inline constexpr DatasetOptions kCoarse{.smoothing_Hz = 20.0, .evaluation_rate_Hz = 100.0, .band_Hz = 6.0};

/// A joint whose rows at rest are left out.
struct RestingJoint {
  int joint = 0;
  bool pushed = false;  ///< by a person, who moves it while it rests

  bool operator==(const RestingJoint&) const = default;
};

/// One stretch without a gap, at the evaluation rate.
struct Series {
  double rate_Hz = 0.0;
  std::size_t lead = 0;  ///< states at its beginning that lead up to the others, and have no rows
  /// Smoothed. The torque is for friction and gains that depend on it: that which a model asks of the drives
  /// for this motion, once one has been set; the measured one before.
  std::vector<model::EffectInput> states;
  std::vector<JointVector> acceleration;        ///< rad/s²
  std::vector<JointVector> measured_torque_Nm;  ///< at the instant, smoothed
  /// A person's push moves the leg and is answered by the controller, so that motion and torque go with what
  /// no model explains. The sinusoids in them do not: they are what was asked for. Of the acceleration,
  /// rad/s², as a variable on which a residual may depend, and of the torque. Without `asked_part` the
  /// acceleration below the band's middle, and no torque.
  std::vector<JointVector> asked_acceleration;
  std::vector<JointVector> asked_torque_Nm;
};

/// Rows first … end−1 of every joint that follow each other in time, of one series.
struct Block {
  Eigen::Index first = 0;
  Eigen::Index end = 0;
  std::size_t recording = 0;
};

class Dataset {
 public:
  /// Stretches shorter than readable::kShortest_s are left out. Throws std::invalid_argument where nothing
  /// remains.
  Dataset(std::span<const Recording> recordings, const DatasetOptions& options);

  int joints() const noexcept { return joints_; }
  /// Number of one joint's rows.
  Eigen::Index rows() const noexcept { return rows_; }
  /// Rows a second, in the analysis band.
  double rate_Hz() const noexcept { return rate_Hz_; }
  double band_Hz() const noexcept { return band_Hz_; }
  bool isStatic() const noexcept { return is_static_; }
  std::span<const Series> series() const noexcept { return series_; }
  std::span<const Block> blocks() const noexcept { return blocks_; }

  /// Puts a torque that belongs to each state through the band.
  Column column(const std::function<JointVector(const Series&, std::size_t)>& torque) const;

  /// The same of a torque on one joint alone.
  Column jointColumn(int joint, const std::function<double(const Series&, std::size_t)>& torque) const;

  /// Predicts the torque on which friction and gains depend from the motion. Were it the measured one, an
  /// effect in proportion to it would explain whatever was measured. Effects of the drive
  /// (EffectDescriptor::of_drive) take the measured torque all the same: it is what goes into the drive, what
  /// comes out of it is filtered, and the motion holds a person's pushes, which do not pass through the
  /// drive.
  void setPredictedTorque(const std::function<JointVector(const Series&, std::size_t)>& torque_Nm);

  /// Takes all of a joint's torque for asked for, and not its sinusoids alone.
  void askForWholeTorque(int joint);
  /// Torque of the drives, as measured.
  Column driveTorque() const;
  /// Torque that a model needs for the recorded motion.
  Column modelTorque(model::DynamicsModel& dynamics) const;
  /// The same of a mechanism alone, as if it stood at q + offset where q is measured.
  Column mechanismTorque(const model::Mechanism& mechanism, const JointVector& offset_rad) const;
  /// Torque that an effect takes from the drives: −torque() + ΔI ddq.
  Column effectTorque(model::Effect& effect) const;
  /// The same, driven by the part of the torque that the motion asked for.
  Column askedEffectTorque(model::Effect& effect) const;
  /// Columns of the mechanism's regressor, as if it stood at q + offset where q is measured; as Columns.
  Eigen::MatrixXd regressor(const model::Mechanism& mechanism, const JointVector& offset_rad) const;
  /// Leaves out the rows in which a chosen joint rests. What is compared comes up smoothly after a rest
  /// before it goes through the band, so that no torque at rest is mixed into the motion. Nothing is left out
  /// of postures, or where too little would remain (resting::kLeastLeft): false then.
  bool leaveOutRest(std::span<const RestingJoint> joints);
  /// The same rows with the states of every series changed: read in another way. Their number and rate stay.
  Dataset changed(const std::function<void(Series&)>& change) const;
  /// A variable of one joint's state through the band, as `rows()` values.
  Eigen::VectorXd variable(const std::function<double(const Series&, std::size_t)>& value) const;
  /// Time of each row, s.
  const Eigen::VectorXd& time_s() const noexcept { return time_s_; }
  /// Gain of the band for a sinusoid.
  double gain(double frequency_Hz) const noexcept;

 private:
  /// As column(), with start(series) before the first state of each series and torque(series, i) in the order
  /// of time.
  template <typename Start, typename Torque>
  Column columnOf(Start start, Torque torque) const;
  /// As effectTorque(), of an effect that takes input(series, i).
  template <typename Input>
  Column effectColumn(model::Effect& effect, Input input) const;
  /// The same of an effect without inertia, which acts on its own joint alone.
  template <typename Input>
  Column ownJointColumn(model::Effect& effect, Input input) const;
  Eigen::VectorXd band(std::span<const double> signal, const Series& series) const;
  std::size_t edgeSamples(double rate_Hz) const noexcept;
  /// First state with a row.
  std::size_t firstOf(const Series& series) const noexcept;
  /// Recordings of different rates come to about the same: each series keeps one of so many of its samples.
  std::size_t decimation(double rate_Hz) const noexcept;
  /// Puts the rows of a series that are kept into one joint's part of a Column, from its row `first` on.
  void put(const Eigen::VectorXd& banded, std::size_t series, Eigen::Index first,
           Eigen::Ref<Eigen::VectorXd> column) const;
  /// Blocks, number and times of the rows that are kept.
  void countRows();

  int joints_;
  bool is_static_;
  double rate_Hz_ = 0.0;
  double band_Hz_ = 0.0;
  Eigen::Index rows_ = 0;
  Eigen::VectorXd time_s_;
  std::vector<Series> series_;
  std::vector<std::size_t> recording_;           ///< of each series
  std::vector<std::vector<double>> weights_;     ///< of each series' states; empty: 1
  std::vector<std::vector<Eigen::Index>> kept_;  ///< of each series, which of the band's rows
  std::vector<Block> blocks_;
};

/// The same recordings cut in two: all but the last `fraction` of each stretch, and that. A stretch whose
/// parts would be too short stays whole in the first. Of postures at rest every few are held out.
struct SplitRecordings {
  std::vector<Recording> train;
  std::vector<Recording> heldout;
};
SplitRecordings split(std::span<const Recording> recordings, double heldout_fraction);

}  // namespace patella::diagnose
