// How a fit moves through the parameters of an effect: which of them enter linearly, where to look for the
// others, and what it takes for a value to make physical sense.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

/// A weight and the effect parameters that it multiplies.
struct BasisTerm {
  double weight = 1.0;
  std::vector<double> parameters;
};

struct NonlinearParameter {
  double lower = 0.0;
  double upper = 0.0;
  /// Over which derivatives are taken. 0: a thousandth of the range. Above: the objective is rugged, and
  /// steps of this size without derivatives come first.
  double step = 0.0;
  bool closed_below = false;  ///< an effect at the lower bound is another than its name says
  bool open_above = false;    ///< one at the upper bound is not: beyond it all look alike
  double spread = 0.0;        ///< standard deviation about zero that is known beforehand; 0: nothing is
  /// Standard deviation that comes of what the recipe assumes of nature, however little noise there is.
  double assumption = 0.0;
};

/// torque(c, ν) = Σ c_i basis_i(ν); an effect without coefficients has one basis that counts once.
struct Recipe {
  std::string kind;
  int joint = 0;
  std::string variant;  ///< tells recipes of one kind apart: "direction −1", "viscous only"; mostly empty
  /// One per coefficient: true where physics allows no negative value.
  std::vector<bool> nonnegative;
  double largest = 1e30;  ///< of a coefficient, either sign
  std::vector<NonlinearParameter> nonlinear;
  std::vector<std::vector<double>>
      grid;  ///< points ν at which the search looks; one empty point where ν is empty
  /// More points, from one of which a descent reaches the lowest valley of a rugged objective.
  std::vector<std::vector<double>> valleys;
  /// Parameters of the effect, in the order of its descriptor.
  std::function<std::vector<double>(std::span<const double> c, std::span<const double> nu)> parameters;
  std::function<std::vector<std::vector<BasisTerm>>(std::span<const double> nu)> basis;
  /// Kinds whose torque is a special case of this one, its own among them where a joint has but one of it:
  /// they are replaced, not added to.
  std::vector<std::string> contains;
  /// Name of a parameter that c and ν together put where it cannot be, although each is possible by itself;
  /// mostly none.
  std::function<std::string(std::span<const double> c, std::span<const double> nu)> beyond;
  /// The torque is nearly proportional to ν[0], so that a first estimate follows from any point of the grid.
  bool proportional = false;
  /// Physical parameters are products of exponentials of ν: what is uncertain of them is a factor.
  bool by_factors = false;
  /// Parameters that follow from what the recipe assumes: they have no interval, and are not listed.
  std::vector<std::string> assumed;
  /// The drive gives more or less than it was told: all that the other effects and the mechanism take from it
  /// counts 1 − c times.
  bool scales_all = false;
  /// The mechanism stands at q + ν[0] where q is measured.
  bool shifts_angle = false;
  /// Driven by the part of the torque that the motion asked for (see Series).
  bool by_asked_torque = false;

  std::size_t coefficients() const noexcept { return nonnegative.size(); }
  std::string label() const { return kind + "@" + std::to_string(joint + 1); }
};

/// Recipes of the named kinds for every joint that moves and may have them, scaled to the motion in the data.
/// `channels`: EMG channels that were recorded; `smoothing_rad_s`: of each joint's dry friction.
std::vector<std::shared_ptr<const Recipe>> recipes(const Dataset& data,
                                                   const model::MechanismDescription& description,
                                                   std::span<const std::string> kinds,
                                                   std::span<const int> channels,
                                                   std::span<const double> smoothing_rad_s);

/// Coulomb friction alone, at this smoothing velocity.
std::shared_ptr<const Recipe> dryFriction(int joint, double smoothing_rad_s);

/// The variable on which an effect shows: "q", "dq", "ddq", "tau", "time" or "activation".
std::string_view betrayingVariable(std::string_view kind);

/// Whether an effect may be part of a function of the position, to which a constant belongs, too.
bool isOfPosition(std::string_view kind);

}  // namespace patella::diagnose
