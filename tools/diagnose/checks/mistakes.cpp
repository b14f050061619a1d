#include "tools/diagnose/checks/mistakes.hpp"

#include <array>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/format.h>

namespace patella::diagnose {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMillimetre = 1e-3;

struct TorqueUnit {
  const char* name;
  const char* change;
  double in_Nm;
};
constexpr std::array kTorqueUnits{TorqueUnit{"kN·m", "·1000", 1e3},
                                  TorqueUnit{"mN·m or N·mm", "/1000", 1e-3},
                                  TorqueUnit{"N·cm", "/100", 1e-2},
                                  TorqueUnit{"kgf·m", "·9.81", 9.80665},
                                  TorqueUnit{"kgf·cm", "·0.0981", 0.0980665},
                                  TorqueUnit{"lbf·in", "·0.113", 0.1129848},
                                  TorqueUnit{"ozf·in", "·0.00706", 0.00706155}};
constexpr std::array kForceUnits{TorqueUnit{"kN", "·1000", 1e3}, TorqueUnit{"mN", "/1000", 1e-3},
                                 TorqueUnit{"kgf", "·9.81", 9.80665}, TorqueUnit{"lbf", "·4.45", 4.44822}};

void scale(std::vector<double>& values, double factor) {
  for (double& value : values) {
    value *= factor;
  }
}

void shift(std::vector<double>& values, double offset) {
  for (double& value : values) {
    value += offset;
  }
}

// Of one joint, or of all where `joint` is negative.
std::vector<std::size_t> chosen(int joint, int joints) {
  if (joint >= 0) {
    return {static_cast<std::size_t>(joint)};
  }
  std::vector<std::size_t> all(static_cast<std::size_t>(joints));
  for (std::size_t j = 0; j < all.size(); ++j) {
    all[j] = j;
  }
  return all;
}

// Names of the columns of the chosen joints: "q1_rad and q2_rad".
std::string columnNames(const std::string& stem, const std::string& unit, int joint, int joints) {
  std::string names;
  for (const std::size_t j : chosen(joint, joints)) {
    names += fmt::format("{}{}{}{}", names.empty() ? "" : " and ", stem, j + 1, unit);
  }
  return names;
}

class Mistakes {
 public:
  Mistakes(int joints, bool revolute) : joints_(joints), revolute_(revolute) {}

  std::vector<Mistake> all() {
    for (int joint = joints_ > 1 ? -1 : 0; joint < joints_; ++joint) {
      units(joint);
      signs(joint);
      columns(joint);
    }
    if (joints_ == 2) {
      betweenJoints();
    }
    if (revolute_) {
      zeros();
    }
    return std::move(all_);
  }

 private:
  using Signals = std::array<std::vector<double>, kMaxJoints> Recording::*;

  void add(std::string mistake, std::string change, std::function<void(Recording&)> correct) {
    all_.push_back({std::move(mistake), std::move(change), std::move(correct)});
  }

  void addScaled(Signals signals, int joint, double factor, std::string mistake, std::string change) {
    add(std::move(mistake), std::move(change), [=, joints = joints_](Recording& recording) {
      for (const std::size_t j : chosen(joint, joints)) {
        scale((recording.*signals)[j], factor);
      }
    });
  }

  std::string position(int joint) const {
    return columnNames("q", revolute_ ? "_rad" : "_m", joint, joints_);
  }
  std::string torque(int joint) const { return columnNames("tau", revolute_ ? "_Nm" : "_N", joint, joints_); }
  std::string q(int joint) const { return joint < 0 ? "all q" : fmt::format("q{}", joint + 1); }
  std::string tau(int joint) const { return joint < 0 ? "all tau" : fmt::format("tau{}", joint + 1); }
  const char* verb(int joint) const { return joint < 0 ? "are" : "is"; }

  void units(int joint) {
    const auto q_and = [&](const char* text) { return q(joint) + text; };
    const auto tau_and = [&](const char* text) { return tau(joint) + text; };
    const auto is = [&](const std::string& what, const char* text) {
      return fmt::format("{} {} {}", what, verb(joint), text);
    };
    const Signals positions = &Recording::position_rad;
    if (revolute_) {
      addScaled(positions, joint, kDegree, is(position(joint), "in degrees"), q_and("·π/180"));
      addScaled(positions, joint, 1.0 / kDegree, is(position(joint), "converted from degrees twice"),
                q_and("·180/π"));
      addScaled(positions, joint, 2.0 * std::numbers::pi, is(position(joint), "in turns"), q_and("·2π"));
      addScaled(positions, joint, 1e-3, is(position(joint), "in milliradians"), q_and("/1000"));
    } else {
      addScaled(positions, joint, kMillimetre, is(position(joint), "in millimetres"), q_and("/1000"));
    }
    addTorque(joint, kDegree, is(torque(joint), "too large by 180/π"), tau_and("·π/180"));
    addTorque(joint, 1.0 / kDegree, is(torque(joint), "too small by 180/π"), tau_and("·180/π"));
    // One drive that has no current may look like a unit of its own: see torque_units.hpp for that.
    if (joint < 0 || joints_ == 1) {
      const std::span<const TorqueUnit> known =
          revolute_ ? std::span<const TorqueUnit>(kTorqueUnits) : std::span<const TorqueUnit>(kForceUnits);
      for (const TorqueUnit& unit : known) {
        addTorque(joint, unit.in_Nm, fmt::format("{} {} in {}", torque(joint), verb(joint), unit.name),
                  tau_and(unit.change));
      }
    }
  }

  void addTorque(int joint, double factor, std::string mistake, std::string change) {
    addScaled(&Recording::torque_Nm, joint, factor, std::move(mistake), std::move(change));
    all_.back().torque_factor.assign(static_cast<std::size_t>(joints_), 1.0);
    for (const std::size_t j : chosen(joint, joints_)) {
      all_.back().torque_factor[j] = factor;
    }
  }

  void signs(int joint) {
    const auto reversed = [&](const std::string& what) {
      return fmt::format("{} {} of the other sign", what, verb(joint));
    };
    addScaled(&Recording::position_rad, joint, -1.0, reversed(position(joint)), "−" + q(joint));
    addScaled(&Recording::torque_Nm, joint, -1.0, reversed(torque(joint)), "−" + tau(joint));
    add(fmt::format("{} and {} are of the other sign", position(joint), torque(joint)),
        fmt::format("−{} and −{}", q(joint), tau(joint)), [=, joints = joints_](Recording& recording) {
          for (const std::size_t j : chosen(joint, joints)) {
            scale(recording.position_rad[j], -1.0);
            scale(recording.torque_Nm[j], -1.0);
          }
        });
  }

  void columns(int joint) {
    add(fmt::format("{} and {} are swapped", position(joint), torque(joint)),
        fmt::format("{} for {}", tau(joint), q(joint)), [=, joints = joints_](Recording& recording) {
          for (const std::size_t j : chosen(joint, joints)) {
            std::swap(recording.position_rad[j], recording.torque_Nm[j]);
          }
        });
  }

  void betweenJoints() {
    add("q1_rad and q2_rad are swapped", "q2 for q1",
        [](Recording& r) { std::swap(r.position_rad[0], r.position_rad[1]); });
    add("tau1_Nm and tau2_Nm are swapped", "tau2 for tau1",
        [](Recording& r) { std::swap(r.torque_Nm[0], r.torque_Nm[1]); });
    add("the joints are swapped", "q2 for q1 and tau2 for tau1", [](Recording& r) {
      std::swap(r.position_rad[0], r.position_rad[1]);
      std::swap(r.torque_Nm[0], r.torque_Nm[1]);
    });
    for (const double sign : {-1.0, 1.0}) {
      add("q2_rad is not relative to the first segment", sign < 0.0 ? "q2 − q1" : "q2 + q1",
          [=](Recording& r) {
            for (std::size_t i = 0; i < r.rows(); ++i) {
              r.position_rad[1][i] += sign * r.position_rad[0][i];
            }
          });
    }
  }

  // Angles of the first joint count from the horizontal; many a machine counts from hanging or upright.
  void zeros() {
    for (const double sign : {-1.0, 1.0}) {
      add("q1_rad is not zero where the segment is horizontal", sign < 0.0 ? "q1 − π/2" : "q1 + π/2",
          [=](Recording& r) { shift(r.position_rad[0], sign * 0.5 * std::numbers::pi); });
    }
  }

  int joints_;
  bool revolute_;
  std::vector<Mistake> all_;
};

}  // namespace

std::vector<Mistake> mistakes(int joints, bool revolute) {
  return Mistakes(joints, revolute).all();
}

}  // namespace patella::diagnose
