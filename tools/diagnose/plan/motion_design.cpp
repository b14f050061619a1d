#include "tools/diagnose/plan/motion_design.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>

#include "sim/random.hpp"
#include "tools/diagnose/plan/staircase.hpp"

namespace patella::diagnose {
namespace {

/// Share of the evaluations that looks for starts. The best of them share the next, staircases varied as
/// such, and the amplitudes of the best of those are varied for the rest.
constexpr double kLooking = 0.2;
constexpr double kClimbing = 0.6;
/// Share of the starts that are staircases.
constexpr double kStaircases = 0.5;
constexpr int kClimbed = 4;
/// Steps of an evolution strategy: larger after a success, smaller after a failure, so that one in five
/// succeeds (Rechenberg 1973; Kern et al. 2004, Natural Computing 3, 77–112).
constexpr double kStepOfStart = 0.3;
constexpr double kStepOfRest = 0.1;
constexpr double kGrowth = 1.5;
constexpr double kSmallestStep = 1e-3;
/// One in two steps moves one joint only.
constexpr double kWholeSteps = 0.5;
/// Written digits of amplitudes, offsets and phases.
constexpr double kResolution = 1e-5;
/// A motion that rounding puts over a limit is made smaller by as much.
constexpr double kShrink = 0.99;
constexpr int kMostShrinks = 60;

struct Climber {
  Eigen::VectorXd point;             ///< of the family
  std::vector<Staircase> staircase;  ///< of each joint, as long as the point is made of them
  double value = -std::numeric_limits<double>::infinity();
  double step = kStepOfStart;
};

class MotionSearch {
 public:
  MotionSearch(MotionFamily& family, Information& information, const DesignOptions& options)
      : family_(family), information_(information), options_(options), random_(options.seed) {}

  Climber best() {
    const auto count = [&](double share) {
      return std::max(1, static_cast<int>(share * options_.evaluations));
    };
    std::vector<Climber> climbers;
    for (int i = 0; i < std::max(kClimbed, count(kLooking)); ++i) {
      climbers.push_back(drawn());
    }
    std::sort(climbers.begin(), climbers.end(),
              [](const Climber& a, const Climber& b) { return a.value > b.value; });
    climbers.resize(kClimbed);
    if (!std::isfinite(climbers.front().value)) {
      throw std::runtime_error(
          "no motion was found within the limits: of the motions that were tried, each asks for more torque, "
          "speed or room of the end point than is allowed. Give more of them, a longer blend, or another "
          "start");
    }
    for (Climber& climber : climbers) {
      climb(climber, count(kClimbing) / kClimbed);
    }
    Climber& highest =
        *std::max_element(climbers.begin(), climbers.end(),
                          [](const Climber& a, const Climber& b) { return a.value < b.value; });
    highest.staircase.clear();
    highest.step = kStepOfRest;
    climb(highest, options_.evaluations - used_);
    return highest;
  }

  double first() const noexcept { return first_; }

 private:
  double valueOf(const Eigen::VectorXd& point) {
    ++used_;
    if (options_.progress) {
      options_.progress(static_cast<double>(used_) / options_.evaluations);
    }
    const auto motion = family_.at(point);
    if (!motion) {
      return -std::numeric_limits<double>::infinity();
    }
    const double value = information_.logDeterminant(family_.sampled(*motion));
    first_ = std::isnan(first_) ? value : first_;
    return value;
  }

  // Only proportions of amplitudes count: without a scale, steps keep their meaning.
  void normalise(Eigen::VectorXd& point) const {
    for (int j = 0; j < family_.joints(); ++j) {
      const Eigen::Index first = j * family_.numbersOfJoint();
      point[first] = std::clamp(point[first], -1.0, 1.0);
      point[first + 1] = std::clamp(point[first + 1], 0.0, 1.0);
      auto amplitudes = point.segment(family_.firstAmplitude(j), family_.numbersOfJoint() - 2);
      amplitudes /= std::max(amplitudes.norm(), 1e-12);
    }
  }

  auto amplitudes(Eigen::VectorXd& point, int joint) const {
    return point.segment(family_.firstAmplitude(joint), family_.numbersOfJoint() - 2);
  }

  void place(const Staircase& staircase, int joint, Eigen::VectorXd& point) const {
    amplitudes(point, joint) = staircase.shape(family_.periods(joint));
  }

  Climber drawn() {
    Climber climber{.point = Eigen::VectorXd(family_.dimensions()), .staircase = {}};
    const bool stays = random_.uniform() < kStaircases;
    for (int j = 0; j < family_.joints(); ++j) {
      const Eigen::Index first = j * family_.numbersOfJoint();
      climber.point[first] = 2.0 * random_.uniform() - 1.0;
      climber.point[first + 1] = 1.0;
      if (stays) {
        climber.staircase.push_back(Staircase::drawn(family_.periods(j).maxCoeff(), random_));
        place(climber.staircase.back(), j, climber.point);
        continue;
      }
      auto shape = amplitudes(climber.point, j);
      for (Eigen::Index k = 0; k < shape.size(); ++k) {
        // Fast parts of large amplitude would take all of the speed.
        shape[k] = random_.gaussian() / static_cast<double>(1 + k % (shape.size() / 2));
      }
    }
    normalise(climber.point);
    climber.value = valueOf(climber.point);
    return climber;
  }

  Climber nearby(const Climber& climber) {
    Climber other = climber;
    const bool whole = random_.uniform() < kWholeSteps;
    const int moved = static_cast<int>(random_.uniform() * family_.joints());
    const double size = climber.step / std::sqrt(static_cast<double>(family_.numbersOfJoint()));
    for (int j = 0; j < family_.joints(); ++j) {
      if (!whole && j != moved) {
        continue;
      }
      auto numbers = other.point.segment(j * family_.numbersOfJoint(), family_.numbersOfJoint());
      for (double& number : numbers) {
        number += size * random_.gaussian();
      }
      if (!climber.staircase.empty()) {
        Staircase& staircase = other.staircase[static_cast<std::size_t>(j)];
        staircase = staircase.varied(climber.step, random_);
        place(staircase, j, other.point);
      }
    }
    normalise(other.point);
    other.value = valueOf(other.point);
    return other;
  }

  void climb(Climber& climber, int evaluations) {
    for (int i = 0; i < evaluations && used_ < options_.evaluations; ++i) {
      const double step = climber.step;
      Climber other = nearby(climber);
      const bool higher = other.value > climber.value;
      if (higher) {
        climber = std::move(other);
      }
      climber.step = higher ? step * kGrowth : std::max(kSmallestStep, step * std::pow(kGrowth, -0.25));
    }
  }

  MotionFamily& family_;
  Information& information_;
  const DesignOptions& options_;
  sim::Random random_;
  int used_ = 0;
  double first_ = std::nan("");
};

double rounded(double value) {
  return std::round(value / kResolution) * kResolution;
}

control::ReferenceSettings rounded(control::ReferenceSettings reference, int joints) {
  for (int j = 0; j < joints; ++j) {
    auto& waves = std::get<control::MultisineMotion>(reference.motion[static_cast<std::size_t>(j)]);
    waves.offset_rad = rounded(waves.offset_rad);
    for (control::SineComponent& component : waves.components) {
      component.amplitude_rad = rounded(component.amplitude_rad);
      component.phase_rad = rounded(component.phase_rad);
    }
  }
  return reference;
}

}  // namespace

DesignedMotion designMotion(MotionFamily& family, Information& information, const JointVector& start_rad,
                            const MotionLimits& limits, const std::optional<Reach>& reach,
                            TorqueAlong& torque, double duration_s, const DesignOptions& options) {
  MotionSearch search(family, information, options);
  const Climber best = search.best();
  FourierMotion motion = family.at(best.point).value();
  DesignedMotion designed;
  designed.first_log_determinant = search.first();
  for (int shrink = 0; shrink <= kMostShrinks; ++shrink) {
    designed.reference = rounded(family.reference(motion), family.joints());
    designed.use =
        limitUse(designed.reference, start_rad, limits, reach, torque, duration_s, options.rate_Hz);
    if (designed.use.kept()) {
      designed.sampled = family.sampled(motion);
      designed.log_determinant = information.logDeterminant(designed.sampled);
      return designed;
    }
    motion.amplitude_rad *= kShrink;
  }
  throw std::runtime_error("the motion that was found does not fit the limits between two ticks of the loop");
}

}  // namespace patella::diagnose
