// Conventions that a recording may have been made with, other than the model's: units, signs, order of
// columns, zeros, clocks. Each is a change of a motion's states that would put it right.
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose {

enum class ConventionKind {
  kPositionUnit,
  kTorqueUnit,  ///< or the wrong side of a gear
  kPositionSign,
  kTorqueSign,
  kBothSigns,
  kPositionsExchanged,
  kTorquesExchanged,
  kJointsExchanged,
  kColumnsExchanged,  ///< position and torque of a joint
  kAbsoluteAngle,     ///< of the second joint, where it should count from the first link
  kZero,              ///< of an angle; of the first joint by π: gravity's sign
  kTorqueShift,       ///< in time, against the position
  kMounting,          ///< angle of the base to gravity
  kTwo,               ///< two of these at once
};

inline constexpr int kAllJoints = -1;

/// From … to, the smaller first.
using Range = std::array<double, 2>;

struct Convention {
  ConventionKind kind{};
  int joint = kAllJoints;  ///< from 0; or the kind says which
  double number = 0.0;     ///< recorded per right unit; right less recorded zero, or angle of a base, rad;
                           ///< torque too late, s
  Range range{};           ///< of numbers that explain as much, where one was searched for
  std::array<int, 2> exchanged{-1, -1};  ///< joints whose columns are read for each other
  std::string mistake{};                 ///< "q2_rad is in degrees"
  std::string change{};                  ///< "q2·π/180": what would put it right
  std::function<void(Series&)> correct{};
  bool torque_only = false;         ///< positions stay as they are
  std::vector<Convention> parts{};  ///< of kTwo: which
};

/// Whether it holds for the convention, or for one of two at once.
template <typename Which>
bool anyPart(const Convention& convention, Which which) {
  return convention.parts.empty() ? which(convention)
                                  : std::any_of(convention.parts.begin(), convention.parts.end(), which);
}

/// A recording is in another convention than its model; each of `conventions` explains it.
class WrongConvention : public std::invalid_argument {
 public:
  WrongConvention(const std::string& what, std::vector<Convention> conventions)
      : std::invalid_argument(what), conventions_(std::move(conventions)) {}
  const std::vector<Convention>& conventions() const noexcept { return conventions_; }

 private:
  std::vector<Convention> conventions_;
};

/// Names of columns, as messages have them.
struct ColumnNames {
  int joints = 1;
  std::vector<bool> slides{};  ///< of each joint; none slides where it is empty
  bool turns(int joint) const { return slides.empty() || !slides[static_cast<std::size_t>(joint)]; }
  std::string position(int joint) const;  ///< "q1_rad", "q1_rad and q2_rad"
  /// Of those that turn, or of those that slide.
  std::string position(int joint, bool turning) const;
  std::string torque(int joint) const;
  const char* verb(int joint) const { return joint < 0 ? "are" : "is"; }
};

/// All whose size is known: units of positions, signs, exchanged columns and joints. Those that turn or scale
/// angles are there for each zero that a first joint may count from: horizontal, hanging, upright.
std::vector<Convention> knownConventions(const ColumnNames& names);

/// Angles as counts of encoders of usual resolutions.
std::vector<Convention> encoderCounts(const ColumnNames& names);

/// The zero of a joint's angle is `offset_rad` away from the model's.
Convention zeroConvention(const ColumnNames& names, int joint, double offset_rad);

/// Whether a torque comes early by no more than drives are late.
bool mayBeLateDrive(const Convention& convention);

/// A torque, or all (−1), comes `late_s` after the position of the same row; early where that is negative.
/// The message has the range of what explains as much.
Convention shiftConvention(const ColumnNames& names, int joint, double late_s, const Range& range_s);

/// Known units of a torque, or of all (−1).
std::vector<Convention> torqueUnits(const ColumnNames& names, int joint);

/// A torque, or all (−1), is `factor` times what it should be, as it is before or behind a gear. The message
/// has the range of what explains as much.
Convention gearConvention(const ColumnNames& names, int joint, double factor, const Range& range);

/// Likely unit of an angle of such a size: degrees, milliradians, counts of an encoder.
const char* likelyAngleUnit(double largest_angle);

}  // namespace patella::diagnose
