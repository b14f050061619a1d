// What no motion within the limits can tell more of than this, whatever its shape and duration allow.
#pragma once

#include <span>

#include <Eigen/Core>

#include "tools/diagnose/plan/motion_columns.hpp"

namespace patella::diagnose {

/// Upper bound of the information on one effect's size beside the columns that stand in its way, over all
/// motions within the limits of position, speed and torque.
///
/// A motion of weight N (its independent samples) is a distribution ξ over states x = (q, q̇, τ). Beside the
/// other columns n, with what is known of them beforehand, P, the effect's column s has the information
///   I(ξ) = min over v of  N E_ξ |s(x) − n(x) v|² + vᵀ P v,
/// which is concave in ξ. So for any v, no motion has more than  max over x of N |s(x) − n(x) v|²  + vᵀ P v.
/// States are exchanged until the best distribution on those at hand comes within a few percent of that.
/// Source: Atkinson, Donev and Tobias 2007, Optimum Experimental Designs, Chapter 9 (general equivalence
/// theorem), with the prior of Chapter 18. The maximum over x is searched for from many draws, and not
/// proven.
struct BestStates {
  double attained = 0.0;  ///< of a distribution that was found; no motion need have it
  double bound = 0.0;
};
/// `noise_Nm` of each joint; `samples` N. Both are 0 where no state tells anything of the effect.
BestStates bestStates(MotionColumns& columns, Eigen::Index main, std::span<const Eigen::Index> beside,
                      std::span<const double> noise_Nm, double samples, const MotionLimits& limits);

}  // namespace patella::diagnose
