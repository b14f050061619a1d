#include "tools/diagnose/effects/recipe_names.hpp"

#include <cmath>
#include <vector>

#include "core/model/effect.hpp"

namespace patella::diagnose {
namespace {

// The parameter that differs most, relative to its range, between two settings of an effect.
std::string differingName(const Recipe& recipe, std::span<const double> one, std::span<const double> other) {
  const auto parameters = model::findEffect(recipe.kind)->parameters;
  std::size_t most = 0;
  double largest = -1.0;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    const double apart = std::abs(one[p] - other[p]) / (parameters[p].maximum - parameters[p].minimum);
    if (apart > largest) {
      largest = apart;
      most = p;
    }
  }
  return std::string(parameters[most].name);
}

}  // namespace

std::string coefficientName(const Recipe& recipe, std::span<const double> nu, std::size_t index) {
  if (recipe.coefficients() == 0) {
    return shapeName(recipe, {}, nu, 0);
  }
  std::vector<double> c(recipe.coefficients(), 0.0);
  const std::vector<double> without = recipe.parameters(c, nu);
  c[index] = 1.0;
  return differingName(recipe, without, recipe.parameters(c, nu));
}

std::string shapeName(const Recipe& recipe, std::span<const double> c, std::span<const double> nu,
                      std::size_t index) {
  std::vector<double> moved(nu.begin(), nu.end());
  const NonlinearParameter& range = recipe.nonlinear[index];
  moved[index] = moved[index] < 0.5 * (range.lower + range.upper) ? range.upper : range.lower;
  return differingName(recipe, recipe.parameters(c, nu), recipe.parameters(c, moved));
}

}  // namespace patella::diagnose
