#include "tools/diagnose/effects/recipe_parts.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

namespace patella::diagnose {

Parameters::Parameters(std::string_view kind) : descriptor_(model::findEffect(kind)) {
  for (const model::EffectParameter& parameter : descriptor_->parameters) {
    values_.push_back(parameter.initial);
  }
}

Parameters& Parameters::set(std::string_view name, double value) {
  const std::size_t index = indexOf(name);
  const model::EffectParameter& range = descriptor_->parameters[index];
  values_[index] = std::clamp(value, range.minimum, range.maximum);
  return *this;
}

const model::EffectParameter& Parameters::of(std::string_view name) const {
  return descriptor_->parameters[indexOf(name)];
}

std::size_t Parameters::indexOf(std::string_view name) const {
  const auto found = std::find_if(descriptor_->parameters.begin(), descriptor_->parameters.end(),
                                  [name](const auto& parameter) { return parameter.name == name; });
  if (found == descriptor_->parameters.end()) {
    throw std::logic_error(fmt::format("effect {} has no parameter {}", descriptor_->kind, name));
  }
  return static_cast<std::size_t>(found - descriptor_->parameters.begin());
}

std::vector<std::vector<double>> product(const std::vector<std::vector<double>>& axes) {
  std::vector<std::vector<double>> points{{}};
  for (const std::vector<double>& axis : axes) {
    std::vector<std::vector<double>> grown;
    for (const auto& point : points) {
      for (const double value : axis) {
        grown.push_back(point);
        grown.back().push_back(value);
      }
    }
    points = std::move(grown);
  }
  return points;
}

std::vector<double> range(double from, double to, double step) {
  std::vector<double> values;
  for (double value = from; value <= to; value += step) {
    values.push_back(value);
  }
  return values;
}

Recipe start(const char* kind, const Motion& motion, std::vector<bool> nonnegative) {
  Recipe recipe;
  recipe.kind = kind;
  recipe.joint = motion.joint;
  recipe.nonnegative = std::move(nonnegative);
  recipe.grid = {{}};
  return recipe;
}

Recipe single(const char* kind, const Motion& motion, const char* strength, bool nonnegative,
              double smoothing) {
  Recipe recipe = start(kind, motion, {nonnegative});
  recipe.contains = {kind};
  recipe.parameters = [=](Numbers c, Numbers) -> std::vector<double> {
    Parameters parameters(kind);
    parameters.set(strength, c[0]);
    if (smoothing > 0.0) {
      parameters.set(kSmoothing, smoothing);
    }
    return parameters;
  };
  return recipe;
}

Recipe oscillation(const char* kind, const Motion& motion, const char* frequency,
                   std::vector<double> frequencies) {
  Recipe recipe = start(kind, motion, {false, false});
  const double step = frequencies.size() > 1 ? frequencies[1] - frequencies[0] : 0.1;
  recipe.nonlinear = {{.lower = frequencies.front() - step, .upper = frequencies.back() + step}};
  recipe.grid = product({std::move(frequencies)});
  recipe.parameters = [=](Numbers c, Numbers nu) -> std::vector<double> {
    return Parameters(kind)
        .set("amplitude_Nm", std::hypot(c[0], c[1]))
        .set(frequency, nu[0])
        .set("phase_rad", std::atan2(c[1], c[0]));
  };
  return recipe;
}

}  // namespace patella::diagnose
