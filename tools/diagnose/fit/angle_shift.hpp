// Change of a mechanism's regressor by an encoder's offset, as a function of the offset.
#pragma once

#include <Eigen/Core>

#include "core/model/mechanism.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// Hundreds of offsets are tried, and each regressor has to be evaluated and filtered. In axes that turn with
/// the joint, motion and weight of what comes before it are linear in sine and cosine of the offset, and
/// wrenches quadratic in the motion; turning them back to an earlier joint is once more linear. So the
/// regressor is a trigonometric polynomial of order 3, and seven offsets give any other. Where the joint
/// slides, it is a polynomial of order 3, and four are enough.
class AngleShift {
 public:
  /// `data` and `mechanism` have to last while it is constructed only.
  AngleShift(const Dataset& data, const model::Mechanism& mechanism, int joint, bool slides);

  /// regressor(q + offset on the joint) − regressor(q), as Columns; rad or m.
  Eigen::MatrixXd at(double offset) const;

 private:
  bool slides_;
  Eigen::Index rows_;
  Eigen::MatrixXd parts_;  ///< regressor that goes with each function of the offset, as one column
};

}  // namespace patella::diagnose
