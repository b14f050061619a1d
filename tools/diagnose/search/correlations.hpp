// Which of the fitted parameters a recording cannot tell apart.
#pragma once

#include <span>
#include <string>

#include <Eigen/Core>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Between the mechanism's parameters (`mechanism_names`, with their derivatives by ModelFit::mechanism, a row
/// each) and those of every effect in it, declared and found, that the recording determines. `covariance` is
/// that of the fit's parameters.
Correlations correlationsOf(const ModelFit& fit, std::span<const std::string> mechanism_names,
                            const Eigen::MatrixXd& mechanism_slopes, const Eigen::MatrixXd& covariance);

}  // namespace patella::diagnose
