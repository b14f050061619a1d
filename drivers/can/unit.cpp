#include "drivers/can/unit.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <string>
#include <utility>

namespace patella::can {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kMinute_s = 60.0;

struct NamedUnit {
  std::string_view name;  ///< as plain() leaves it
  Unit unit;
};

constexpr std::array kUnits = {
    NamedUnit{"rad", {Dimension::kAngle, 1.0}},
    NamedUnit{"mrad", {Dimension::kAngle, 1e-3}},
    NamedUnit{"urad", {Dimension::kAngle, 1e-6}},
    NamedUnit{"deg", {Dimension::kAngle, kDegree}},
    NamedUnit{"degree", {Dimension::kAngle, kDegree}},
    NamedUnit{"degrees", {Dimension::kAngle, kDegree}},
    NamedUnit{"Deg", {Dimension::kAngle, kDegree}},
    NamedUnit{"mdeg", {Dimension::kAngle, 1e-3 * kDegree}},
    NamedUnit{"rev", {Dimension::kAngle, kTurn}},
    NamedUnit{"turn", {Dimension::kAngle, kTurn}},
    NamedUnit{"turns", {Dimension::kAngle, kTurn}},
    NamedUnit{"rad/s", {Dimension::kRate, 1.0}},
    NamedUnit{"mrad/s", {Dimension::kRate, 1e-3}},
    NamedUnit{"deg/s", {Dimension::kRate, kDegree}},
    NamedUnit{"Deg/s", {Dimension::kRate, kDegree}},
    NamedUnit{"dps", {Dimension::kRate, kDegree}},
    NamedUnit{"mdeg/s", {Dimension::kRate, 1e-3 * kDegree}},
    NamedUnit{"rpm", {Dimension::kRate, kTurn / kMinute_s}},
    NamedUnit{"RPM", {Dimension::kRate, kTurn / kMinute_s}},
    NamedUnit{"rev/min", {Dimension::kRate, kTurn / kMinute_s}},
    NamedUnit{"r/min", {Dimension::kRate, kTurn / kMinute_s}},
    NamedUnit{"1/min", {Dimension::kRate, kTurn / kMinute_s}},
    NamedUnit{"rev/s", {Dimension::kRate, kTurn}},
    NamedUnit{"turn/s", {Dimension::kRate, kTurn}},
    NamedUnit{"rps", {Dimension::kRate, kTurn}},
    NamedUnit{"rad/s2", {Dimension::kAcceleration, 1.0}},
    NamedUnit{"deg/s2", {Dimension::kAcceleration, kDegree}},
    NamedUnit{"Nm", {Dimension::kTorque, 1.0}},
    NamedUnit{"mNm", {Dimension::kTorque, 1e-3}},
    NamedUnit{"uNm", {Dimension::kTorque, 1e-6}},
    NamedUnit{"kNm", {Dimension::kTorque, 1e3}},
    NamedUnit{"cNm", {Dimension::kTorque, 1e-2}},
    NamedUnit{"Ncm", {Dimension::kTorque, 1e-2}},
    NamedUnit{"Nmm", {Dimension::kTorque, 1e-3}},
    NamedUnit{"V", {Dimension::kVoltage, 1e3}},
    NamedUnit{"mV", {Dimension::kVoltage, 1.0}},
    NamedUnit{"uV", {Dimension::kVoltage, 1e-3}},
    NamedUnit{"nV", {Dimension::kVoltage, 1e-6}},
    NamedUnit{"A", {}},
    NamedUnit{"mA", {}},
    NamedUnit{"%", {}},
    NamedUnit{"Hz", {}},
    NamedUnit{"s", {}},
    NamedUnit{"ms", {}},
    NamedUnit{"us", {}},
    NamedUnit{"degC", {Dimension::kTemperature, 1.0}},
    NamedUnit{"K", {}},
};

/// Spellings in which units of one meaning differ: "N.m" and "N·m" are "Nm", "rad/s^2" is "rad/s2", "µV" is
/// "uV". Both code points of the micro sign are in use.
std::string plain(std::string_view text) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 11> kSpellings = {{{"\u00B5", "u"},
                                                                                         {"\u03BC", "u"},
                                                                                         {"\u00B0", "deg"},
                                                                                         {"\u00B7", ""},
                                                                                         {"\u22C5", ""},
                                                                                         {"\u00B2", "2"},
                                                                                         {"/sec", "/s"},
                                                                                         {" ", ""},
                                                                                         {".", ""},
                                                                                         {"*", ""},
                                                                                         {"^", ""}}};
  std::string result;
  while (!text.empty()) {
    const auto* spelling = std::find_if(kSpellings.begin(), kSpellings.end(), [&](const auto& candidate) {
      return text.starts_with(candidate.first);
    });
    const bool found = spelling != kSpellings.end();
    result += found ? spelling->second : text.substr(0, 1);
    text.remove_prefix(found ? spelling->first.size() : 1);
  }
  return result;
}

}  // namespace

std::string_view unitName(Dimension dimension) noexcept {
  constexpr std::array<std::string_view, 8> kNames = {"rad", "rad/s", "rad/s²", "N·m", "mV", "°C", "", ""};
  return kNames[static_cast<std::size_t>(dimension)];
}

std::optional<Unit> findUnit(std::string_view text) {
  const std::string name = plain(text);
  const auto* found = std::find_if(kUnits.begin(), kUnits.end(),
                                   [&](const NamedUnit& candidate) { return candidate.name == name; });
  return found == kUnits.end() ? std::nullopt : std::optional(found->unit);
}

}  // namespace patella::can
