// The numbers of a leg or a single joint that a fit may move: masses, centres of mass, inertias.
#pragma once

#include "tools/diagnose/fit/mechanism_parameters.hpp"

namespace patella::diagnose {

/// z: logarithms of the ratios to the nominal parameters, without those that are zero, which have no ratio.
class PhysicalParameters final : public MechanismParameters {
 public:
  /// `nominal`: no chain.
  PhysicalParameters(const model::MechanismDescription& nominal, bool keeps_scale);

  std::size_t count() const noexcept override { return names_.size(); }
  model::MechanismDescription at(std::span<const double> z) const override;
  model::BaseParameters baseParameters(std::span<const double> z) const override;
  std::array<double, 2> range(std::size_t index) const override;
  /// The scale, where it is kept, is taken off the masses, moments and inertias.
  std::vector<double> settled(std::span<const double> z) const override;
  std::vector<NamedParameter> named(std::span<const double> z) const override;
  Eigen::MatrixXd namedSlopes(std::span<const double> z) const override;

 private:
  model::MechanismDescription nominal_;
  bool keeps_scale_;
  std::vector<std::string> names_;
  std::vector<double> values_;
  std::vector<double> largest_logarithm_;  ///< by which a value may grow
};

}  // namespace patella::diagnose
