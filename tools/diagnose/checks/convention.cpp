#include "tools/diagnose/checks/convention.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/checks/series_changes.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kTurn = 2.0 * std::numbers::pi;

struct Unit {
  const char* name;    ///< "in degrees"
  const char* change;  ///< "·π/180"
  double recorded;     ///< number for one radian, newton metre, metre or newton
};
constexpr std::array kAngleUnits{Unit{"in degrees", "·π/180", 1.0 / kDegree},
                                 Unit{"converted from degrees twice", "·180/π", kDegree},
                                 Unit{"in turns", "·2π", 1.0 / kTurn}, Unit{"in milliradians", "/1000", 1e3}};
constexpr std::array kLengthUnits{Unit{"in millimetres", "/1000", 1e3}};
constexpr std::array kTorqueUnits{Unit{"in MN·m", "·10⁶", 1e-6},
                                  Unit{"in kN·m", "·1000", 1e-3},
                                  Unit{"too small by 180/π", "·180/π", kDegree},
                                  Unit{"in kgf·m", "·9.81", 1.0 / 9.80665},
                                  Unit{"in lbf·in", "·0.113", 1.0 / 0.1129848},
                                  Unit{"in kgf·cm", "·0.0981", 1.0 / 0.0980665},
                                  Unit{"too large by 180/π", "·π/180", 1.0 / kDegree},
                                  Unit{"in N·cm", "/100", 1e2},
                                  Unit{"in ozf·in", "·0.00706", 1.0 / 0.00706155},
                                  Unit{"in mN·m or N·mm", "/1000", 1e3},
                                  Unit{"in µN·m", "/10⁶", 1e6}};
constexpr std::array kForceUnits{Unit{"in kN", "·1000", 1e-3}, Unit{"in kgf", "·9.81", 1.0 / 9.80665},
                                 Unit{"in lbf", "·4.45", 1.0 / 4.44822}, Unit{"in mN", "/1000", 1e3}};

std::string q(int joint) {
  return joint < 0 ? "all q" : fmt::format("q{}", joint + 1);
}

std::string tau(int joint) {
  return joint < 0 ? "all tau" : fmt::format("tau{}", joint + 1);
}

bool of(int joint, Eigen::Index index) {
  return joint == kAllJoints || joint == index;
}

class Known {
 public:
  explicit Known(const ColumnNames& names) : names_(names) {
    zeros_.emplace_back(JointVector::Zero(names.joints));
    if (names.turns(0)) {
      for (const double sign : {-1.0, 1.0}) {
        zeros_.push_back(zeros_.front());
        zeros_.back()[0] = sign * 0.5 * std::numbers::pi;
      }
    }
  }

  std::vector<Convention> counts() {
    constexpr int kFewestBits = 10, kMostBits = 24;
    for (int joint = names_.joints > 1 ? kAllJoints : 0; joint < names_.joints; ++joint) {
      for (int bits = kFewestBits; bits <= kMostBits; ++bits) {
        const double recorded = std::ldexp(1.0, bits) / kTurn;
        addPositions(named(ConventionKind::kPositionUnit, joint,
                           fmt::format("{} {} in counts of an encoder of {} bits", names_.position(joint),
                                       names_.verb(joint), bits),
                           fmt::format("{}·2π/2^{}", q(joint), bits), recorded),
                     scaled(joint, 1.0 / recorded), unit());
      }
    }
    return std::move(all_);
  }

  std::vector<Convention> all() {
    for (int joint = names_.joints > 1 ? kAllJoints : 0; joint < names_.joints; ++joint) {
      units(joint);
      signs(joint);
      columns(joint);
    }
    for (int first = 0; first < names_.joints; ++first) {
      for (int second = first + 1; second < names_.joints; ++second) {
        betweenJoints(first, second);
      }
    }
    absoluteAngles();
    return std::move(all_);
  }

 private:
  JointMatrix unit() const { return JointMatrix::Identity(names_.joints, names_.joints); }

  JointMatrix scaled(int joint, double factor) const {
    JointMatrix matrix = unit();
    for (Eigen::Index j = 0; j < matrix.rows(); ++j) {
      matrix(j, j) = of(joint, j) ? factor : 1.0;
    }
    return matrix;
  }

  // Once for each zero about which it makes another motion.
  void addPositions(const Convention& convention, const JointMatrix& position, const JointMatrix& torque) {
    std::vector<JointVector> shifts;
    for (const JointVector& zero : zeros_) {
      const JointVector shift = zero - position * zero;
      bool known = false;
      for (const JointVector& other : shifts) {
        known = known || (shift - other).norm() < 1e-9;
      }
      if (!known) {
        shifts.push_back(shift);
        all_.push_back(convention);
        all_.back().correct = [=](Series& series) {
          turnPositions(series, position, zero);
          turnTorques(series, torque);
        };
      }
    }
  }

  void addTorques(Convention convention, const JointMatrix& torque) {
    convention.torque_only = true;
    convention.correct = [=](Series& series) { turnTorques(series, torque); };
    all_.push_back(std::move(convention));
  }

  static Convention named(ConventionKind kind, int joint, std::string mistake, std::string change,
                          double number = 0.0) {
    return {.kind = kind,
            .joint = joint,
            .number = number,
            .mistake = std::move(mistake),
            .change = std::move(change),
            .correct = {}};
  }

  // All angles, or all ways on rails, may be in another unit together.
  void units(int joint) {
    for (const bool turning : {true, false}) {
      JointMatrix concerned = JointMatrix::Zero(names_.joints, names_.joints);
      for (int j = 0; j < names_.joints; ++j) {
        concerned(j, j) = of(joint, j) && names_.turns(j) == turning ? 1.0 : 0.0;
      }
      if (concerned.isZero()) {
        continue;
      }
      for (const Unit& unit_of :
           turning ? std::span<const Unit>(kAngleUnits) : std::span<const Unit>(kLengthUnits)) {
        addPositions(
            named(ConventionKind::kPositionUnit, joint,
                  fmt::format("{} {} {}", names_.position(joint, turning), names_.verb(joint), unit_of.name),
                  q(joint) + unit_of.change, unit_of.recorded),
            unit() + (1.0 / unit_of.recorded - 1.0) * concerned, unit());
      }
    }
  }

  void signs(int joint) {
    const auto reversed = [&](const std::string& what) {
      return fmt::format("{} {} of the other sign", what, names_.verb(joint));
    };
    const JointMatrix turned = scaled(joint, -1.0);
    addTorques(named(ConventionKind::kTorqueSign, joint, reversed(names_.torque(joint)), "−" + tau(joint)),
               turned);
    addPositions(
        named(ConventionKind::kPositionSign, joint, reversed(names_.position(joint)), "−" + q(joint)), turned,
        unit());
    addPositions(
        named(ConventionKind::kBothSigns, joint,
              fmt::format("{} and {} are of the other sign", names_.position(joint), names_.torque(joint)),
              fmt::format("−{} and −{}", q(joint), tau(joint))),
        turned, turned);
  }

  void columns(int joint) {
    Convention convention =
        named(ConventionKind::kColumnsExchanged, joint,
              fmt::format("{} and {} are swapped", names_.position(joint), names_.torque(joint)),
              fmt::format("{} for {}", tau(joint), q(joint)));
    convention.correct = [joint, joints = names_.joints](Series& series) {
      for (Eigen::Index j = 0; j < joints; ++j) {
        if (of(joint, j)) {
          exchangeColumns(series, j);
        }
      }
    };
    all_.push_back(std::move(convention));
  }

  void betweenJoints(int first, int second) {
    JointMatrix exchanged = unit();
    exchanged.row(first).swap(exchanged.row(second));
    const auto swapped = [&](ConventionKind kind, const std::string& what, const std::string& change) {
      Convention convention = named(kind, kAllJoints, what + " are swapped", change);
      convention.exchanged = {first, second};
      return convention;
    };
    const auto pair = [&](auto name) { return name(first) + " and " + name(second); };
    const auto position = [this](int joint) { return names_.position(joint); };
    const auto torque = [this](int joint) { return names_.torque(joint); };
    const std::string q_for_q = fmt::format("{} for {}", q(second), q(first));
    const std::string tau_for_tau = fmt::format("{} for {}", tau(second), tau(first));
    addPositions(swapped(ConventionKind::kPositionsExchanged, pair(position), q_for_q), exchanged, unit());
    addTorques(swapped(ConventionKind::kTorquesExchanged, pair(torque), tau_for_tau), exchanged);
    addPositions(
        swapped(ConventionKind::kJointsExchanged,
                names_.joints == 2 ? "the joints" : fmt::format("joints {} and {}", first + 1, second + 1),
                q_for_q + " and " + tau_for_tau),
        exchanged, exchanged);
  }

  // All angles but the first, which each count from the segment before.
  void absoluteAngles() {
    for (int j = 0; j < names_.joints; ++j) {
      if (names_.joints < 2 || !names_.turns(j)) {
        return;
      }
    }
    for (const double sign : {-1.0, 1.0}) {
      JointMatrix relative = unit();
      std::string later, change;
      for (int j = 1; j < names_.joints; ++j) {
        relative(j, j - 1) = sign;
        later += fmt::format("{}q{}_rad", j == 1 ? "" : " and ", j + 1);
        change += fmt::format("{}q{} {} q{}", j == 1 ? "" : ", ", j + 1, sign < 0.0 ? "−" : "+", j);
      }
      const bool pair = names_.joints == 2;
      addPositions(named(ConventionKind::kAbsoluteAngle, pair ? 1 : kAllJoints,
                         fmt::format("{} {} not relative to the {}", later, pair ? "is" : "are",
                                     pair ? "first segment" : "segments before"),
                         change, sign),
                   relative, unit());
    }
  }

  ColumnNames names_;
  std::vector<JointVector> zeros_;
  std::vector<Convention> all_;
};

Convention scaleConvention(int joint, double factor, std::string mistake, std::string change) {
  return {.kind = ConventionKind::kTorqueUnit,
          .joint = joint,
          .number = factor,
          .mistake = std::move(mistake),
          .change = std::move(change),
          .correct =
              [=](Series& series) {
                for (JointVector& torque_Nm : series.measured_torque_Nm) {
                  for (Eigen::Index j = 0; j < torque_Nm.size(); ++j) {
                    torque_Nm[j] /= of(joint, j) ? factor : 1.0;
                  }
                }
              },
          .torque_only = true};
}

// `which`: whether the joint's column is among them.
template <typename Which>
std::string columns(const ColumnNames& all, const char* stem, const char* turning, const char* sliding,
                    Which which) {
  std::string names;
  for (int j = 0; j < all.joints; ++j) {
    if (which(j)) {
      names += fmt::format("{}{}{}{}", names.empty() ? "" : " and ", stem, j + 1,
                           all.turns(j) ? turning : sliding);
    }
  }
  return names;
}

// Two digits at least.
std::string number(double value) {
  return std::abs(value) < 9.95 ? fmt::format("{:.1f}", value) : fmt::format("{:.0f}", value);
}

// "6.8", or "6.8 to 64".
std::string fromTo(double least, double most) {
  return number(least) == number(most) ? number(least) : number(least) + " to " + number(most);
}

bool mayBeDelay(double early_s) {
  return early_s > 0.0 && early_s <= physicalRange("actuator_delay", "delay_s")[1];
}

}  // namespace

std::string ColumnNames::position(int joint) const {
  return columns(*this, "q", "_rad", "_m", [=](int j) { return of(joint, j); });
}

std::string ColumnNames::position(int joint, bool turning) const {
  return columns(*this, "q", "_rad", "_m", [=, this](int j) { return of(joint, j) && turns(j) == turning; });
}

std::string ColumnNames::torque(int joint) const {
  return columns(*this, "tau", "_Nm", "_N", [=](int j) { return of(joint, j); });
}

std::vector<Convention> knownConventions(const ColumnNames& names) {
  return Known(names).all();
}

std::vector<Convention> encoderCounts(const ColumnNames& names) {
  return Known(names).counts();
}

Convention zeroConvention(const ColumnNames& names, int joint, double offset_rad) {
  const bool upside_down = std::abs(std::abs(offset_rad) - std::numbers::pi) < convention::kSameZero_rad;
  return {
      .kind = ConventionKind::kZero,
      .joint = joint,
      .number = offset_rad,
      .mistake = fmt::format("the zero of {} is off by {:.2f} rad ({:.0f}°){}", names.position(joint),
                             offset_rad, offset_rad / kDegree,
                             joint == 0 && upside_down ? ", or gravity is of the other sign" : ""),
      .change = fmt::format("q{} {} {:.2f}", joint + 1, offset_rad < 0.0 ? "−" : "+", std::abs(offset_rad)),
      .correct = [=](Series& series) {
        for (model::EffectInput& state : series.states) {
          state.q[joint] += offset_rad;
        }
      }};
}

bool mayBeLateDrive(const Convention& convention) {
  return convention.kind == ConventionKind::kTorqueShift && mayBeDelay(-convention.number);
}

Convention shiftConvention(const ColumnNames& names, int joint, double late_s, const Range& range_s) {
  constexpr double kMillisecond = 1e-3;
  const bool late = late_s > 0.0;
  const double nearest_s = late ? range_s[0] : -range_s[1], farthest_s = late ? range_s[1] : -range_s[0];
  return {
      .kind = ConventionKind::kTorqueShift,
      .joint = joint,
      .number = late_s,
      .range = range_s,
      .mistake = fmt::format(
          "{} {} {} ms too {}{}", names.torque(joint), joint < 0 && names.joints > 1 ? "come" : "comes",
          fromTo(std::max(nearest_s, 0.0) / kMillisecond, farthest_s / kMillisecond), late ? "late" : "early",
          mayBeDelay(-late_s) ? ", or the drive acts that late: declare actuator_delay" : ""),
      .change = fmt::format("{} {:.0f} ms {}", tau(joint), std::abs(late_s) / kMillisecond,
                            late ? "earlier" : "later"),
      .correct =
          [=](Series& series) {
            for (Eigen::Index j = 0; j < series.measured_torque_Nm.front().size(); ++j) {
              if (of(joint, j)) {
                advanceTorque(series, j, late_s);
              }
            }
          },
      .torque_only = true};
}

std::vector<Convention> torqueUnits(const ColumnNames& names, int joint) {
  const std::span<const Unit> units = names.turns(std::max(joint, 0)) ? std::span<const Unit>(kTorqueUnits)
                                                                      : std::span<const Unit>(kForceUnits);
  std::vector<Convention> all;
  for (const Unit& unit : units) {
    all.push_back(scaleConvention(joint, unit.recorded,
                                  fmt::format("{} {} {}", names.torque(joint), names.verb(joint), unit.name),
                                  tau(joint) + unit.change));
  }
  return all;
}

Convention gearConvention(const ColumnNames& names, int joint, double factor, const Range& range) {
  const bool before = factor < 1.0;
  const double least = before ? 1.0 / range[1] : range[0], most = before ? 1.0 / range[0] : range[1];
  Convention convention =
      scaleConvention(joint, factor,
                      fmt::format("{} {} measured {} a gear of {}", names.torque(joint), names.verb(joint),
                                  before ? "before" : "behind", fromTo(least, most)),
                      tau(joint) + (before ? "·" : "/") + number(before ? 1.0 / factor : factor));
  convention.range = range;
  return convention;
}

const char* likelyAngleUnit(double largest_angle) {
  constexpr double kTurns = convention::kLargestAngle_rad / kTurn;
  constexpr double kPerTurnDegrees = 360.0, kPerTurnMilliradians = 1e3 * kTurn;
  return largest_angle <= kTurns * kPerTurnDegrees        ? "degrees"
         : largest_angle <= kTurns * kPerTurnMilliradians ? "milliradians or counts of an encoder"
                                                          : "counts of an encoder";
}

}  // namespace patella::diagnose
