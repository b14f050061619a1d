// Chance for a dependence so strong that the noise of the fit is mostly the dependence itself.
#pragma once

#include <cstdint>

#include "tools/diagnose/search/screening.hpp"

namespace patella::diagnose {

/// Only atoms of so few columns are looked at: functions of many leave less of any noise, and a second look
/// at them finds less than the first.
inline constexpr Eigen::Index kColumnsOfSecondLook = 2;

struct SecondLook {
  Screened screened;  ///< the most surprising atom, its gain in units of the noise that it leaves
  double p_value = 1.0;
};

/// A screening draws chance from what the fit leaves. Where an atom explains most of that, the draws hold it
/// too, and it seems likely by chance. Here the noise of the most surprising atom is what that atom leaves.
/// Noise is calmer without any function of it that is fitted, so every draw of the fit's noise goes through
/// the same: the atom that is most surprising in it, what that one leaves, and the gain in units of that. p
/// is 1 where no atom is so small. `nuisance` as the screening had it.
SecondLook lookAgain(const Dataset& data, const ModelFit& fit, const Atoms& atoms,
                     const Eigen::MatrixXd& nuisance, const Screening& screening,
                     const Screening::Statistic& statistic, int replicates, std::uint64_t seed);

}  // namespace patella::diagnose
