// How well a model explains a recording that is read in one convention or another.
#pragma once

#include <array>
#include <map>
#include <vector>

#include <Eigen/Core>

#include "core/model/dynamics_model.hpp"
#include "core/model/model_description.hpp"
#include "tools/diagnose/checks/convention.hpp"
#include "tools/diagnose/fit/angle_shift.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// Each joint's residual torque, over the joint's load: the torque, or the largest term of
/// the model where the joint is not driven, so that passive joints count as much as driven ones.
struct Reading {
  std::vector<double> load_Nm;  ///< rms of what each joint's errors are shares of
  /// With parameters within convention::kOwnRange, and rubbing: every machine rubs. 0 where a joint is at
  /// rest as recorded and as read: dry friction holds there against whatever it has to.
  std::vector<double> error;
  /// The same rest over the torque alone; 1 where it explains nothing.
  std::vector<double> error_of_torque;
  /// With parameters within a factor of convention::kOtherLeg, every plain effect, and a body on the last
  /// link of a chain. Of a recording as given only.
  std::vector<double> error_with_effects{};
};

/// Sum over the joints of the logarithms of an error, none below that of convention::kFloor: the
/// log-likelihood of a noise of unknown size on each joint, but for a factor. One joint that is plainly wrong
/// is not hidden by one that fits.
double misfit(const std::vector<double>& error, double floor);

class Reader {
 public:
  Reader(Dataset data, const model::ModelDescription& model);

  int joints() const noexcept { return data_.joints(); }
  bool moves() const;
  /// Whether a joint is at rest beside the others, as recorded.
  bool hasJointAtRest() const;
  /// Whether a joint that turns stays within convention::kLeastBend_rad, as recorded.
  bool hasJointThatHardlyBends() const;
  Reading asGiven() const;
  /// Of the recording as given.
  double load_Nm(int joint) const { return own_load_Nm_[static_cast<std::size_t>(joint)]; }
  Reading read(const Convention& convention);
  /// A reader of the recording with the convention put right. Errors stay shares of no more than the load as
  /// given.
  Reader putRight(const Convention& convention) const;
  /// Of the recording as given, Reading::error_with_effects beside a sinusoid of each joint that is not in
  /// its motion.
  std::vector<double> errorBesideTremor() const;

 private:
  enum Freedom { kRubbing, kAllEffects };
  /// Torque that a motion needs from the drives, whatever they gave.
  struct Columns {
    Eigen::MatrixXd model;    ///< of its base parameters, as they are
    Eigen::MatrixXd rubbing;  ///< rubbingColumns()
  };
  /// Of one joint's rows, in the mean: all that least squares need.
  struct Sums {
    Eigen::MatrixXd gram;   ///< columns with columns, those of the model before the effects'
    Eigen::VectorXd right;  ///< columns with the torque
    double power = 0.0;     ///< the torque squared, (N·m)²
    double load = 0.0;      ///< rms of the torque or of the model's largest term, N·m
  };
  struct Fitted {
    Eigen::VectorXd strengths;  ///< of every column
    std::vector<double> error;  ///< of each joint, over its load
  };
  Columns columnsOf(const Dataset& data) const;
  /// Of the recording as given: all that is known, then otherColumns(), then bodyColumns().
  Eigen::MatrixXd allOfGiven() const;
  Eigen::MatrixXd declaredOf(const Dataset& data) const;
  /// With another zero of one joint that turns.
  Columns turned(const Convention& zero);
  /// `exchanged`: as in Convention, of positions.
  Reading readingOf(const std::vector<Sums>& sums, const Columns& columns,
                    const std::array<int, 2>& exchanged) const;
  std::vector<bool> restOf(const Columns& columns) const;
  std::vector<Sums> sumsOf(const Eigen::MatrixXd& columns, const Column& torque) const;
  std::vector<Sums> sumsOf(const Columns& columns, const Column& torque) const;
  /// The same of the own columns, whose products with each other are known.
  std::vector<Sums> sumsOfTorque(const Column& torque) const;
  static std::vector<double> loadsOf(const std::vector<Sums>& sums);
  void measureByGivenLoad(Reading& reading) const;
  Fitted fit(const std::vector<Sums>& sums, Freedom freedom) const;

  Dataset data_;
  model::ModelDescription model_;
  model::DynamicsModel bare_;  ///< its mechanism without effects
  Columns own_;
  Column own_torque_Nm_;
  std::vector<Sums> own_sums_;
  std::vector<bool> at_rest_;
  std::vector<double> largest_inertia_;
  std::vector<double> own_load_Nm_;
  bool torque_scaled_ = false;        ///< its load is another than as given
  std::map<int, AngleShift> shifts_;  ///< by joint, once another zero of it is tried
};

}  // namespace patella::diagnose
