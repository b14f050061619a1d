// A sinusoid in what a model leaves that the motion does not have: a tremor, or a machine that shakes.
#pragma once

#include <Eigen/Core>

namespace patella::diagnose {

/// One joint's rows, all of the same length.
struct JointRows {
  const Eigen::VectorXd& time_s;
  Eigen::VectorXd rest_Nm;
  Eigen::VectorXd velocity_rad_s;
};

/// Sum of squares of the rest, (N·m)², beside the sinusoid of most power between tremor::kLowest_Hz and
/// `highest_Hz` that holds no more than tremor::kOfMotion of the velocity's power; all of it where there is
/// none.
double squareBesideForeignLine(const JointRows& rows, double highest_Hz);

}  // namespace patella::diagnose
