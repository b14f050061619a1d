// How well a model explains a recording that is read in one convention or another.
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "firmware_app/files/model_file.hpp"
#include "tools/diagnose/checks/convention.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// What the model leaves of each joint's torque, over the joint's load: the torque, or the largest term of
/// the model where the joint is not driven, so that passive joints count as much as driven ones.
struct Reading {
  std::vector<double> error;
  /// Sum over the joints of the logarithms, none below that of convention::kFloor: the log-likelihood of a
  /// noise of unknown size on each joint, but for a factor. One joint that is plainly wrong is not hidden by
  /// one that fits.
  double misfit() const;
};

class Reader {
 public:
  /// A model's parameters may be wrong by convention::kOwnRange.
  Reader(Dataset data, const app::ModelDescription& model);

  int joints() const noexcept { return data_.joints(); }
  /// The model and rubbing: every machine rubs.
  Reading asGiven() const { return readingOf(own_, torque_, kRubbing); }
  /// The model within a factor of convention::kWideFactor, and every plain effect.
  Reading withEffects() const;
  Reading read(const Convention& convention) const;
  /// Of each joint: how many times as large the torque is as the model needs it, rubbing and bias taken out
  /// of both; 1 where it does not go with the model's.
  std::vector<double> torqueFactors() const;

 private:
  enum Freedom { kRubbing, kAllEffects };
  /// What a motion needs from the drives, whatever they gave.
  struct Columns {
    Eigen::MatrixXd model;    ///< of its base parameters, as they are
    Eigen::MatrixXd effects;  ///< plain ones, four for each joint
  };
  Columns columnsOf(const Dataset& data) const;
  Eigen::MatrixXd declaredOf(const Dataset& data) const;
  Reading readingOf(const Columns& columns, const Column& torque, Freedom freedom) const;

  Dataset data_;
  app::ModelDescription model_;
  Columns own_;
  Column torque_;
};

}  // namespace patella::diagnose
