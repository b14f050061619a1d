#include "tools/diagnose/checks/mounting.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/fit/base_gravity.hpp"

namespace patella::diagnose {
namespace {

/// Directions of a cube's sides, edges and corners are at most this far from any other; then steps halve.
constexpr double kFirstStep_rad = 0.4;
constexpr double kLastStep_rad = 0.02;

std::vector<Eigen::Vector3d> allAround() {
  std::vector<Eigen::Vector3d> directions;
  for (const double x : {-1.0, 0.0, 1.0}) {
    for (const double y : {-1.0, 0.0, 1.0}) {
      for (const double z : {-1.0, 0.0, 1.0}) {
        if (const Eigen::Vector3d direction(x, y, z); !direction.isZero(0.0)) {
          directions.push_back(direction.normalized());
        }
      }
    }
  }
  return directions;
}

Convention mountingConvention(const Eigen::Vector3d& given_m_s2, const Eigen::Vector3d& gravity_m_s2) {
  const double cosine = given_m_s2.normalized().dot(gravity_m_s2.normalized());
  const double angle_rad = std::acos(std::clamp(cosine, -1.0, 1.0));
  return {.kind = ConventionKind::kMounting,
          .number = angle_rad,
          .mistake = fmt::format("the base stands {:.0f}° off the upright that the model has",
                                 angle_rad * 180.0 / std::numbers::pi),
          .change = fmt::format("gravity_m_s2 = [{:.2f}, {:.2f}, {:.2f}]", gravity_m_s2.x(), gravity_m_s2.y(),
                                gravity_m_s2.z()),
          .correct = {}};
}

}  // namespace

std::optional<ReadAs> bestMounting(const Dataset& data, const model::ModelDescription& model,
                                   const Reading& given) {
  const std::optional<Eigen::Vector3d> gravity_m_s2 = baseGravity(model);
  if (!gravity_m_s2) {
    return std::nullopt;
  }
  std::optional<ReadAs> best;
  Eigen::Vector3d down = Eigen::Vector3d::Zero();
  const auto consider = [&](const Eigen::Vector3d& direction) {
    const Eigen::Vector3d turned_m_s2 = gravity_m_s2->norm() * direction;
    ReadAs one{.convention = mountingConvention(*gravity_m_s2, turned_m_s2),
               .reading = Reader(data, withBaseGravity(model, turned_m_s2)).asGiven()};
    if (!best || gainOf(one, given) > gainOf(*best, given)) {
      best = std::move(one);
      down = direction;
    }
  };
  for (const Eigen::Vector3d& direction : allAround()) {
    consider(direction);
  }
  for (double step = kFirstStep_rad; step > kLastStep_rad; step *= 0.5) {
    const Eigen::Vector3d middle = down, first = middle.unitOrthogonal(), second = middle.cross(first);
    for (const Eigen::Vector3d& aside : {first, second}) {
      consider((middle + step * aside).normalized());
      consider((middle - step * aside).normalized());
    }
  }
  return best;
}

}  // namespace patella::diagnose
