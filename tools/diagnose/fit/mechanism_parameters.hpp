// The free numbers of a mechanism in a fit: what masses, centres of mass and inertias may be.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/model/model_description.hpp"

namespace patella::diagnose {

/// Step of numerical derivatives by a free number.
inline constexpr double kRelativeStep = 1e-4;

/// A parameter as people know it.
struct NamedParameter {
  std::string name;       ///< with its unit, as in model files: "com_m[2]", "ZZ1_kg_m2"
  std::string made_of{};  ///< "ZZ1 + 0.0529 M2" for a base parameter of a chain; empty otherwise
  double nominal = 0.0;
  double value = 0.0;
  /// Spread of the value for a spread of 1 of the free numbers.
  double spread = 0.0;
  bool is_ratio = false;  ///< it is known up to a factor, whose logarithm has this spread over the value
};

/// z, dimensionless and zero at the nominal mechanism, each with the same spread beforehand. Every z makes a
/// mechanism that could be, and that a model file may hold.
class MechanismParameters {
 public:
  virtual ~MechanismParameters() = default;

  /// Of the free numbers.
  virtual std::size_t count() const noexcept = 0;
  virtual model::MechanismDescription at(std::span<const double> z) const = 0;
  /// Of that mechanism.
  virtual model::BaseParameters baseParameters(std::span<const double> z) const = 0;
  /// Within which a number stays, whatever the data say.
  virtual std::array<double, 2> range(std::size_t index) const = 0;
  /// The numbers of the same mechanism that are nearest to what is known.
  virtual std::vector<double> settled(std::span<const double> z) const { return {z.begin(), z.end()}; }
  virtual std::vector<NamedParameter> named(std::span<const double> z) const = 0;
  /// Derivatives of the named values by z: a row each.
  virtual Eigen::MatrixXd namedSlopes(std::span<const double> z) const = 0;

  /// Derivatives of the base parameters by z: a row each.
  Eigen::MatrixXd baseSlopes(std::span<const double> z) const;
};

/// Where no joint is driven, or by little beside what swings (`keeps_scale`), masses, moments and inertias
/// larger by one factor move alike, and smaller ones leave less torque unexplained: then their scale, the
/// length of the base parameters in units of their spread, stays what it is.
std::unique_ptr<MechanismParameters> mechanismParameters(const model::MechanismDescription& nominal,
                                                         bool keeps_scale);

}  // namespace patella::diagnose
