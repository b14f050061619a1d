#include "tools/diagnose/fit/physical_parameters.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include <fmt/format.h>

#include "core/bounds/bounds.hpp"

namespace patella::diagnose {
namespace {

/// A nominal parameter is never moved by more than this factor, whatever the data say.
constexpr double kLargestLogarithm = 1.5;

struct PhysicalParameter {
  std::string name;  ///< as in the model's file, with the link's number: "com_m[2]"
  double* value;
  Bound bound;  ///< that a model file has to keep
};

// Those of `mechanism`, which must outlive them; without those that are zero, which have no ratio.
std::vector<PhysicalParameter> parametersOf(model::MechanismDescription& mechanism) {
  std::vector<PhysicalParameter> all;
  if (auto* leg = std::get_if<model::PlanarTwoLinkParameters>(&mechanism)) {
    for (std::size_t link = 0; link < 2; ++link) {
      const std::string index = fmt::format("[{}]", link + 1);
      all.push_back({"mass_kg" + index, &leg->mass_kg[link], boundOf("mechanism.mass_kg (planar_two_link)")});
      all.push_back({"com_m" + index, &leg->com_m[link], boundOf("mechanism.com_m (planar_two_link)")});
      all.push_back({"inertia_kg_m2" + index, &leg->inertia_kg_m2[link],
                     boundOf("mechanism.inertia_kg_m2 (planar_two_link)")});
    }
  } else if (auto* joint = std::get_if<model::RevoluteJointParameters>(&mechanism)) {
    all.push_back({"inertia_kg_m2", &joint->inertia_kg_m2, boundOf("mechanism.inertia_kg_m2 (revolute)")});
    all.push_back({"moment_kg_m", &joint->moment_kg_m, boundOf("mechanism.moment_kg_m (revolute)")});
  } else {
    all.push_back({"mass_kg", &std::get<model::PrismaticJointParameters>(mechanism).mass_kg,
                   boundOf("mechanism.mass_kg (prismatic)")});
  }
  std::erase_if(all, [](const PhysicalParameter& item) { return *item.value == 0.0; });
  return all;
}

model::BaseParameters baseParametersOf(const model::MechanismDescription& mechanism) {
  return model::makeModel({.mechanism = mechanism, .effects = {}}).mechanism().baseParameters();
}

}  // namespace

PhysicalParameters::PhysicalParameters(const model::MechanismDescription& nominal, bool keeps_scale)
    : nominal_(nominal), keeps_scale_(keeps_scale) {
  model::MechanismDescription mechanism = nominal;
  for (const PhysicalParameter& parameter : parametersOf(mechanism)) {
    names_.push_back(parameter.name);
    values_.push_back(*parameter.value);
    // The result must be a model that can be read again.
    const double room = std::log(parameter.bound.maximum / *parameter.value);
    largest_logarithm_.push_back(std::min(kLargestLogarithm, room));
  }
  if (keeps_scale_) {
    spread_ = spreadsOfBase();
    nominal_scale_ = scaleOf(nominal_);
  }
}

Eigen::VectorXd PhysicalParameters::spreadsOfBase() const {
  const model::BaseParameters base = baseParametersOf(nominal_);
  Eigen::MatrixXd slopes(base.size(), static_cast<Eigen::Index>(count()));
  for (std::size_t i = 0; i < count(); ++i) {
    std::vector<double> moved(count(), 0.0);
    moved[i] = kRelativeStep;
    slopes.col(static_cast<Eigen::Index>(i)) = (baseParametersOf(freeAt(moved)) - base) / kRelativeStep;
  }
  // Nothing of what cannot move counts.
  return (slopes.rowwise().norm().array() > 0.0).select(slopes.rowwise().norm(), HUGE_VAL);
}

double PhysicalParameters::scaleOf(const model::MechanismDescription& mechanism) const {
  return baseParametersOf(mechanism).cwiseQuotient(spread_).norm();
}

// Masses, moments and inertias are in proportion to the base parameters.
std::vector<double> PhysicalParameters::settled(std::span<const double> z) const {
  std::vector<double> scaled(z.begin(), z.end());
  if (!keeps_scale_) {
    return scaled;
  }
  const double grown = std::log(scaleOf(freeAt(z)) / nominal_scale_);
  for (std::size_t i = 0; i < scaled.size(); ++i) {
    scaled[i] -= names_[i].find("_kg") != std::string::npos ? grown : 0.0;
  }
  return scaled;
}

model::MechanismDescription PhysicalParameters::freeAt(std::span<const double> z) const {
  model::MechanismDescription mechanism = nominal_;
  const std::vector<PhysicalParameter> parameters = parametersOf(mechanism);
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const auto& [name, value, range] = parameters[i];
    *value = std::clamp(*value * std::exp(z[i]), range.minimum, range.maximum);
  }
  return mechanism;
}

model::MechanismDescription PhysicalParameters::at(std::span<const double> z) const {
  return freeAt(settled(z));
}

model::BaseParameters PhysicalParameters::baseParameters(std::span<const double> z) const {
  return baseParametersOf(at(z));
}

std::array<double, 2> PhysicalParameters::range(std::size_t index) const {
  return {-kLargestLogarithm, largest_logarithm_[index]};
}

std::vector<NamedParameter> PhysicalParameters::named(std::span<const double> z) const {
  std::vector<NamedParameter> all;
  for (std::size_t i = 0; i < names_.size(); ++i) {
    const double value = values_[i] * std::exp(z[i]);
    all.push_back({.name = names_[i],
                   .nominal = values_[i],
                   .value = value,
                   .spread = std::abs(value),
                   .is_ratio = true});
  }
  return all;
}

Eigen::MatrixXd PhysicalParameters::namedSlopes(std::span<const double> z) const {
  Eigen::VectorXd slopes(static_cast<Eigen::Index>(z.size()));
  for (std::size_t i = 0; i < z.size(); ++i) {
    slopes[static_cast<Eigen::Index>(i)] = values_[i] * std::exp(z[i]);
  }
  return slopes.asDiagonal();
}

}  // namespace patella::diagnose
