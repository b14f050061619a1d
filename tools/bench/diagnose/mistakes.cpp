#include "tools/bench/diagnose/mistakes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace patella::bench {
namespace {

using diagnose::Convention;
using diagnose::ConventionKind;
using diagnose::Recording;

constexpr int kAll = -1;
constexpr double kDegree = std::numbers::pi / 180.0;

bool of(int joint, std::size_t j) {
  return joint == kAll || joint == static_cast<int>(j);
}

// One joint is all where there is no other.
bool same(const Convention& convention, int joint, int joints) {
  return joints == 1 || convention.joint == joint;
}

// Within reach of the number, or of what is as good as it.
bool isNear(double truth, double number, const std::array<double, 2>& range, double reach) {
  return std::abs(number - truth) < reach || (range[0] < truth && truth < range[1]);
}

std::array<double, 2> logarithms(const std::array<double, 2>& range) {
  return range[0] > 0.0 ? std::array{std::log(range[0]), std::log(range[1])} : std::array{0.0, 0.0};
}

void mapPositions(Recording& recording, int joint, const std::function<double(double)>& map,
                  double zero_rad) {
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    const double zero = j == 0 ? zero_rad : 0.0;
    for (double& q : recording.position_rad[j]) {
      q = of(joint, j) ? map(q - zero) + zero : q;
    }
  }
}

void scaleTorques(Recording& recording, int joint, double factor) {
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    for (double& tau : recording.torque_Nm[j]) {
      tau *= of(joint, j) ? factor : 1.0;
    }
  }
}

// Rows for which nothing was recorded so much earlier or later are cut off.
void shiftTorque(Recording& recording, int joint, double late_s) {
  const auto rows = static_cast<std::ptrdiff_t>(std::lround(late_s * recording.rate_Hz));
  const auto cut = static_cast<std::size_t>(std::abs(rows));
  auto& torque = recording.torque_Nm[static_cast<std::size_t>(joint)];
  const std::vector<double> before = torque;
  for (diagnose::Segment& segment : recording.segments) {
    for (std::size_t i = segment.first; i < segment.end; ++i) {
      const std::ptrdiff_t from =
          std::clamp(static_cast<std::ptrdiff_t>(i) - rows, static_cast<std::ptrdiff_t>(segment.first),
                     static_cast<std::ptrdiff_t>(segment.end) - 1);
      torque[i] = before[static_cast<std::size_t>(from)];
    }
    if (segment.end - segment.first > 3 * cut) {
      segment.first += rows > 0 ? cut : 0;
      segment.end -= rows < 0 ? cut : 0;
    }
  }
}

class Draw {
 public:
  Draw(const Recording& recording, bool revolute, Random& random)
      : joints_(recording.joints),
        revolute_(revolute),
        joint_(static_cast<int>(random.below(static_cast<std::size_t>(recording.joints)))),
        one_(random.chance(0.5)),
        zero_rad_(revolute && random.chance(0.5) ? -0.5 * std::numbers::pi : 0.0),
        random_(random) {}

  std::optional<Mistake> mistake() {
    constexpr std::size_t kKinds = 8;
    switch (random_.below(kKinds)) {
      case 0:
        return torqueSign();
      case 1:
        return positionSign();
      case 2:
        return exchange();
      case 3:
        return degrees();
      case 4:
        return torqueScale(1e3, "N·mm for N·m");
      case 5:
        return gear();
      case 6:
        return zero();
      default:
        return shift();
    }
  }

 private:
  int chosen() const { return one_ ? joint_ : kAll; }
  std::string name(const char* stem) const {
    return one_ ? fmt::format("{}{}", stem, joint_ + 1) : fmt::format("all {}", stem);
  }
  const char* about() const { return zero_rad_ != 0.0 ? " in the file" : " as read"; }

  Mistake torqueSign() const {
    const int joint = chosen(), joints = joints_;
    return {.kind = one_ ? "sign of one torque" : "sign of all torques",
            .text = name("tau") + " × −1",
            .make = [=](Recording& r) { scaleTorques(r, joint, -1.0); },
            .is =
                [=](const Convention& c) {
                  return c.kind == ConventionKind::kTorqueSign && same(c, joint, joints);
                }};
  }

  Mistake positionSign() const {
    const int joint = chosen(), joints = joints_;
    return {.kind = one_ ? "sign of one position" : "sign of all positions",
            .text = name("q") + " × −1" + about(),
            .make =
                [=, zero = zero_rad_](Recording& r) {
                  mapPositions(
                      r, joint, [](double q) { return -q; }, zero);
                },
            .is =
                [=](const Convention& c) {
                  return c.kind == ConventionKind::kPositionSign && same(c, joint, joints);
                }};
  }

  std::optional<Mistake> exchange() {
    if (joints_ < 2) {
      return std::nullopt;
    }
    constexpr std::array kWhat{ConventionKind::kTorquesExchanged, ConventionKind::kPositionsExchanged,
                               ConventionKind::kJointsExchanged};
    constexpr std::array kNames{"torques", "positions", "both"};
    const std::size_t what = random_.below(kWhat.size());
    const ConventionKind kind = kWhat[what];
    return Mistake{.kind = "joints exchanged",
                   .text = fmt::format("{} exchanged{}", kNames[what], about()),
                   .make =
                       [=, zero = zero_rad_](Recording& r) {
                         if (kind != ConventionKind::kPositionsExchanged) {
                           std::swap(r.torque_Nm[0], r.torque_Nm[1]);
                         }
                         if (kind != ConventionKind::kTorquesExchanged) {
                           for (std::size_t i = 0; i < r.rows(); ++i) {
                             const double first = r.position_rad[0][i] - zero;
                             r.position_rad[0][i] = r.position_rad[1][i] + zero;
                             r.position_rad[1][i] = first;
                           }
                         }
                       },
                   .is =
                       [=](const Convention& c) {
                         return c.kind == kind && c.exchanged == std::array{0, 1};
                       }};
  }

  std::optional<Mistake> degrees() const {
    if (!revolute_) {
      return std::nullopt;
    }
    const int joint = chosen(), joints = joints_;
    return Mistake{.kind = "degrees",
                   .text = name("q") + " in degrees" + about(),
                   .make =
                       [=, zero = zero_rad_](Recording& r) {
                         mapPositions(
                             r, joint, [](double q) { return q / kDegree; }, zero);
                       },
                   .is =
                       [=](const Convention& c) {
                         return c.kind == ConventionKind::kPositionUnit && same(c, joint, joints);
                       }};
  }

  Mistake torqueScale(double factor, const std::string& kind) const {
    constexpr double kSameFactor = 1.5;
    const int joint = chosen(), joints = joints_;
    return {.kind = kind,
            .text = fmt::format("{} × {:.3g}", name("tau"), factor),
            .make = [=](Recording& r) { scaleTorques(r, joint, factor); },
            .is =
                [=](const Convention& c) {
                  return c.kind == ConventionKind::kTorqueUnit && same(c, joint, joints) &&
                         isNear(std::log(factor), std::log(c.number), logarithms(c.range),
                                std::log(kSameFactor));
                }};
  }

  Mistake gear() {
    constexpr std::array kGears{6.0, 10.0, 30.0, 100.0};
    const double ratio = kGears[random_.below(kGears.size())];
    return torqueScale(random_.chance(0.5) ? ratio : 1.0 / ratio, "side of the gear");
  }

  std::optional<Mistake> zero() {
    if (!revolute_) {
      return std::nullopt;
    }
    constexpr double kSameZero_rad = 0.3;
    constexpr std::size_t kTurns = 4;
    const std::size_t turn = random_.below(kTurns);
    const double offset_rad = turn == 0   ? std::numbers::pi
                              : turn == 1 ? random_.sign() * 0.5 * std::numbers::pi
                                          : random_.sign() * random_.uniform(0.3, 1.5);
    const int joint = joint_;
    return Mistake{.kind = turn == 0 && joint == 0 ? "gravity's sign"
                           : turn < 2              ? "zero off by π or π/2"
                                                   : "zero off",
                   .text = fmt::format("q{} + {:.2f}", joint + 1, offset_rad),
                   .make =
                       [=](Recording& r) {
                         mapPositions(
                             r, joint, [=](double q) { return q + offset_rad; }, 0.0);
                       },
                   .is =
                       [=](const Convention& c) {
                         return c.kind == ConventionKind::kZero && c.joint == joint &&
                                std::abs(std::remainder(c.number + offset_rad, 2.0 * std::numbers::pi)) <
                                    kSameZero_rad;
                       }};
  }

  Mistake shift() {
    constexpr double kSameShift = 0.3, kSameShift_s = 0.03;
    const double late_s = random_.sign() * random_.uniform(0.02, 0.2);
    const int joint = joint_, joints = joints_;
    return {.kind = "torque shifted in time",
            .text = fmt::format("tau{} {:+.0f} ms", joint + 1, 1e3 * late_s),
            .make = [=](Recording& r) { shiftTorque(r, joint, late_s); },
            .is =
                [=](const Convention& c) {
                  return c.kind == ConventionKind::kTorqueShift && same(c, joint, joints) &&
                         isNear(late_s, c.number, c.range,
                                std::max(kSameShift_s, kSameShift * std::abs(late_s)));
                }};
  }

  int joints_;
  bool revolute_;
  int joint_;
  bool one_;
  double zero_rad_;
  Random& random_;
};

}  // namespace

std::optional<Mistake> drawMistake(const Recording& recording, bool revolute, Random& random) {
  return Draw(recording, revolute, random).mistake();
}

}  // namespace patella::bench
