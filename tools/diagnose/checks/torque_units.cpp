#include "tools/diagnose/checks/torque_units.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/judgement_limits.hpp"

namespace patella::diagnose {
namespace {

using namespace torque_units;

struct Unit {
  const char* looks_like;  ///< nullptr: angles in another unit have torques of this size, too
  double factor;           ///< recorded number per N·m (N)
};
constexpr std::array kUnits{
    Unit{"MN·m", 1e-6},
    Unit{"kN·m", 1e-3},
    Unit{nullptr, std::numbers::pi / 180.0},
    Unit{"kgf·m", 1.0 / 9.80665},
    Unit{nullptr, 0.5 / std::numbers::pi},
    Unit{nullptr, 2.0 * std::numbers::pi},
    Unit{"kgf·cm or lbf·in", 10.0},
    Unit{nullptr, 180.0 / std::numbers::pi},
    Unit{"N·cm or ozf·in", 118.0},
    Unit{"mN·m or N·mm", 1e3},
    Unit{"µN·m", 1e6},
};

/// How the torque of a joint goes with the model's, friction and bias taken out of both.
struct Ratio {
  double recorded_rms = 0.0;
  double needed_rms = 0.0;
  double factor = 1.0;  ///< recorded per needed
  double share = 0.0;   ///< of the recorded square that goes with the model's
};

Ratio ratioOf(const Dataset& data, const Column& needed, const Column& recorded,
              const std::vector<ElementaryColumn>& effects, int joint) {
  const auto of = [&](const Column& column) -> Eigen::VectorXd {
    return column.segment(joint * data.rows(), data.rows());
  };
  Eigen::MatrixXd nuisance(data.rows(), 0);
  for (const ElementaryColumn& effect : effects) {
    if (effect.joint == joint && effect.kind != "linear_stiffness") {
      const Eigen::VectorXd column = of(effect.torque);
      nuisance.conservativeResize(Eigen::NoChange, nuisance.cols() + 1);
      nuisance.col(nuisance.cols() - 1) = column / std::max(1e-150, column.norm());
    }
  }
  const auto decomposition = nuisance.completeOrthogonalDecomposition();
  const auto without = [&](const Eigen::VectorXd& column) -> Eigen::VectorXd {
    return column - nuisance * decomposition.solve(column);
  };
  const Eigen::VectorXd x = without(of(needed));
  const Eigen::VectorXd y = without(of(recorded));
  Ratio ratio{.recorded_rms = jointRms(data, recorded, joint), .needed_rms = jointRms(data, needed, joint)};
  const double product = x.dot(y);
  if (product > 0.0) {
    ratio.factor = product / x.squaredNorm();
    ratio.share = product * product / (x.squaredNorm() * y.squaredNorm());
  }
  return ratio;
}

const Unit& nearest(double factor) {
  const Unit* best = kUnits.data();
  for (const Unit& unit : kUnits) {
    if (std::abs(std::log(factor / unit.factor)) < std::abs(std::log(factor / best->factor))) {
      best = &unit;
    }
  }
  return *best;
}

bool ofTheModel(const Ratio& ratio) {
  return ratio.share > kGoesWithModel && std::abs(std::log(ratio.factor)) < std::log(kNotOfTheModel);
}

}  // namespace

void requireTorqueUnits(const Recording& recording, const app::ModelDescription& model) {
  const Dataset data(std::span(&recording, 1), kCoarse);
  model::DynamicsModel dynamics = app::makeModel(model);
  const Column needed = data.modelTorque(dynamics);
  const Column recorded = data.driveTorque();
  const std::vector<ElementaryColumn> effects = elementaryColumns(data);
  std::vector<Ratio> ratios;
  bool one_in_order = false;
  for (int joint = 0; joint < data.joints(); ++joint) {
    ratios.push_back(ratioOf(data, needed, recorded, effects, joint));
    one_in_order = one_in_order || ofTheModel(ratios.back());
  }
  const bool linear = std::holds_alternative<model::PrismaticJointParameters>(model.mechanism);
  for (std::size_t j = 0; j < ratios.size(); ++j) {
    const Ratio& ratio = ratios[j];
    const Unit& unit = nearest(ratio.factor);
    if (unit.looks_like != nullptr && ratio.share > (one_in_order ? kOneAlone : kGoesWithModel) &&
        std::abs(std::log(ratio.factor / unit.factor)) < kNearUnit && !ofTheModel(ratio)) {
      throw std::invalid_argument(
          fmt::format("{}: tau{}_{}: {:.2g} rms where this model and motion need {:.2g}: looks like {}",
                      recording.name, j + 1, linear ? "N" : "Nm", ratio.recorded_rms, ratio.needed_rms,
                      linear ? "another unit of force" : unit.looks_like));
    }
  }
}

}  // namespace patella::diagnose
