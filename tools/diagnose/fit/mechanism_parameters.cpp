#include "tools/diagnose/fit/mechanism_parameters.hpp"

#include "tools/diagnose/fit/chain_bodies.hpp"
#include "tools/diagnose/fit/physical_parameters.hpp"

namespace patella::diagnose {

Eigen::MatrixXd MechanismParameters::baseSlopes(std::span<const double> z) const {
  const model::BaseParameters base = baseParameters(z);
  Eigen::MatrixXd slopes(base.size(), static_cast<Eigen::Index>(count()));
  std::vector<double> moved(z.begin(), z.end());
  for (std::size_t i = 0; i < count(); ++i) {
    const double step = z[i] + kRelativeStep <= range(i)[1] ? kRelativeStep : -kRelativeStep;
    moved[i] = z[i] + step;
    slopes.col(static_cast<Eigen::Index>(i)) = (baseParameters(moved) - base) / step;
    moved[i] = z[i];
  }
  return slopes;
}

std::unique_ptr<MechanismParameters> mechanismParameters(const model::MechanismDescription& nominal,
                                                         bool keeps_scale) {
  if (model::isSerialChain(nominal)) {
    return std::make_unique<ChainBodies>(nominal, keeps_scale);
  }
  return std::make_unique<PhysicalParameters>(nominal, keeps_scale);
}

}  // namespace patella::diagnose
