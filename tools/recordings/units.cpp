#include "tools/recordings/units.hpp"

#include <array>
#include <numbers>

namespace patella::diagnose {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kTurn = 2.0 * std::numbers::pi;

constexpr std::array kTime{Unit{"s", 1.0}, Unit{"ms", 1e-3}, Unit{"us", 1e-6}, Unit{"ns", 1e-9}};
constexpr std::array kPosition{Unit{"rad", 1.0}, Unit{"deg", kDegree}, Unit{"turn", kTurn}, Unit{"m", 1.0},
                               Unit{"mm", 1e-3}};
constexpr std::array kVelocity{Unit{"rad/s", 1.0},        Unit{"deg/s", kDegree}, Unit{"turn/s", kTurn},
                               Unit{"rpm", kTurn / 60.0}, Unit{"m/s", 1.0},       Unit{"mm/s", 1e-3}};
constexpr std::array kTorque{Unit{"N.m", 1.0},  Unit{"mN.m", 1e-3}, Unit{"N.mm", 1e-3}, Unit{"N.cm", 1e-2},
                             Unit{"kN.m", 1e3}, Unit{"N", 1.0},     Unit{"kN", 1e3}};
constexpr std::array kEmg{Unit{"mV", 1.0}, Unit{"V", 1e3}, Unit{"uV", 1e-3}};
constexpr std::array kActivation{Unit{"1", 1.0}, Unit{"percent", 0.01}};

}  // namespace

std::span<const Unit> unitsOf(Quantity quantity) noexcept {
  switch (quantity) {
    case Quantity::kTime:
      return kTime;
    case Quantity::kPosition:
      return kPosition;
    case Quantity::kVelocity:
      return kVelocity;
    case Quantity::kTorque:
      return kTorque;
    case Quantity::kEmg:
      return kEmg;
    case Quantity::kActivation:
      return kActivation;
  }
  return {};
}

}  // namespace patella::diagnose
