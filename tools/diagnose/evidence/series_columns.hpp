// Functions of the samples of one joint, as columns.
#pragma once

#include <functional>
#include <vector>

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose::evidence {

/// Share of the velocity's rms over which a tanh turns a dry friction round.
inline constexpr double kTurningShare = 0.01;

/// Value at sample `i` of a series.
using Sample = std::function<double(std::size_t series, std::size_t i)>;

/// The functions as Columns that are zero on the other joints.
Eigen::MatrixXd jointColumns(const Dataset& data, int joint, const std::vector<Sample>& values);

/// rad/s; never 0.
double velocityRms(const Dataset& data, int joint);

}  // namespace patella::diagnose::evidence
