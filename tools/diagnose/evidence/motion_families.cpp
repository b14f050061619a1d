#include <cmath>

#include "tools/diagnose/effects/considered.hpp"
#include "tools/diagnose/effects/recipe.hpp"
#include "tools/diagnose/evidence/drive_kinds.hpp"
#include "tools/diagnose/evidence/families.hpp"
#include "tools/diagnose/evidence/series_columns.hpp"

namespace patella::diagnose::evidence {
namespace {

using Dynamics = std::shared_ptr<const model::DynamicsModel>;

// Relative, of base parameters that left their tolerance.
constexpr double kUsualRunaway = 0.5;

// In proportion to a small offset, which a mounting error is.
Family offset(const Dataset& data, const Dynamics& dynamics, int joint) {
  constexpr double kStep_rad = 0.01;
  constexpr double kUsual_rad = 0.05;
  const auto columns = [&data, dynamics, joint](std::span<const double>) -> Eigen::MatrixXd {
    const auto at = [&](double angle_rad) {
      JointVector angles = JointVector::Zero(data.joints());
      angles[joint] = angle_rad;
      return Eigen::VectorXd(data.regressor(dynamics->mechanism(), angles) *
                             dynamics->mechanism().baseParameters());
    };
    return (at(kStep_rad) - at(-kStep_rad)) / (2.0 * kStep_rad);
  };
  return {.kind = "encoder_offset",
          .joint = joint,
          .nonnegative = {false},
          .sd = kUsual_rad,
          .columns = columns,
          .parameters = [](auto c, auto) { return std::vector<double>{c[0]}; }};
}

Family ofRecipe(const Dataset& data, const Dynamics& dynamics, const std::shared_ptr<const Recipe>& recipe) {
  Family family{
      .kind = recipe->kind,
      .joint = recipe->joint,
      .variant = recipe->variant,
      .nonnegative = recipe->nonnegative,
      .grid = recipe->grid,
      .choices = static_cast<double>(recipe->grid.size()),
      .contains = recipe->contains,
      .columns =
          [&data, dynamics, recipe](std::span<const double> nu) {
            const auto bases = recipe->basis(nu);
            Eigen::MatrixXd columns =
                Eigen::MatrixXd::Zero(data.rows() * data.joints(), static_cast<Eigen::Index>(bases.size()));
            for (std::size_t i = 0; i < bases.size(); ++i) {
              for (const BasisTerm& term : bases[i]) {
                const auto effect =
                    model::makeEffect(recipe->kind, recipe->joint, dynamics->mechanism(), term.parameters);
                columns.col(static_cast<Eigen::Index>(i)) += term.weight * data.effectTorque(*effect);
              }
            }
            return columns;
          },
      .parameters = [recipe](auto c, auto nu) { return recipe->parameters(c, nu); }};
  for (const NonlinearParameter& range : recipe->nonlinear) {
    family.shape.push_back({.lower = range.lower, .upper = range.upper});
  }
  return family;
}

Family baseParameters(const Dataset& data, const Dynamics& dynamics) {
  const model::BaseParameters base = dynamics->mechanism().baseParameters();
  return {.kind = "nominal_parameters",
          .joint = -1,
          .nonnegative = std::vector<bool>(static_cast<std::size_t>(base.size()), false),
          .sd = kUsualRunaway,
          .columns = [&data, dynamics, base](std::span<const double>) -> Eigen::MatrixXd {
            return data.regressor(dynamics->mechanism(), JointVector::Zero(data.joints())) *
                   base.asDiagonal();
          },
          .parameters = [](auto c, auto) { return std::vector<double>(c.begin(), c.end()); }};
}

}  // namespace

std::vector<Family> motionFamilies(const Dataset& data, const model::ModelDescription& nominal,
                                   std::span<const int> channels) {
  const auto dynamics = std::make_shared<const model::DynamicsModel>(
      model::makeModel({.mechanism = nominal.mechanism, .effects = {}}));
  std::vector<std::string> kinds;
  for (const std::string& kind : consideredKinds({})) {
    if (!isOfDrive(kind) && kind != "tremor" && kind != "torque_ripple") {
      kinds.push_back(kind);
    }
  }
  std::vector<double> smoothing_rad_s;
  for (int joint = 0; joint < data.joints(); ++joint) {
    smoothing_rad_s.push_back(kTurningShare * velocityRms(data, joint));
  }
  const bool leg = !std::holds_alternative<model::PrismaticJointParameters>(nominal.mechanism);
  std::vector<Family> all;
  for (const auto& recipe : recipes(data, dynamics->mechanism(), kinds, channels, smoothing_rad_s, leg)) {
    all.push_back(recipe->shifts_angle ? offset(data, dynamics, recipe->joint)
                                       : ofRecipe(data, dynamics, recipe));
  }
  all.push_back(baseParameters(data, dynamics));
  return all;
}

}  // namespace patella::diagnose::evidence
