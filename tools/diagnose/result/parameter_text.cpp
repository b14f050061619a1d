#include "tools/diagnose/result/parameter_text.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "core/model/effect.hpp"

namespace patella::diagnose {
namespace {

struct UnitEnding {
  std::string_view ending;
  std::string_view rotating;
  std::string_view linear;
};

/// Endings of names, longer ones before those that end them.
constexpr std::array<UnitEnding, 14> kUnits{{
    {"_Nms_rad", "N·m·s/rad", "N·s/m"},
    {"_Nm_rad", "N·m/rad", "N/m"},
    {"_log_Nm", "ln(N·m)", "ln(N)"},
    {"_rad_s", "rad/s", "m/s"},
    {"_1_rad", "1/rad", "1/m"},
    {"_per_rad", "1/rad", "1/m"},
    {"_kg_m2", "kg·m²", "kg"},
    {"_kg_m", "kg·m", "kg·m"},
    {"_Nm", "N·m", "N"},
    {"_rad", "rad", "m"},
    {"_kg", "kg", "kg"},
    {"_Hz", "Hz", "Hz"},
    {"_m", "m", "m"},
    {"_s", "s", "s"},
}};

const Units kLinear{.position = "m", .torque = "N"};

std::string words(std::string_view name) {
  std::string text(name);
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

/// Two digits that count, without an exponent; of a positive number.
std::string twoDigits(double value) {
  const int decimals = 1 - static_cast<int>(std::floor(std::log10(value)));
  return fmt::format("{:.{}f}", value, std::max(decimals, 0));
}

}  // namespace

Units unitsOf(const Diagnosis& diagnosis) {
  const model::MechanismDescription& mechanism = diagnosis.extended.mechanism;
  if (model::isLinear(mechanism)) {
    return kLinear;
  }
  Units units;
  for (int joint = 0; joint < diagnosis.extended.joints(); ++joint) {
    if (model::isPrismatic(mechanism, joint)) {
      return {.position = units.position + " or " + kLinear.position,
              .torque = units.torque + " or " + kLinear.torque};
    }
  }
  return units;
}

Units unitsOf(const model::MechanismDescription& mechanism, int joint) {
  return model::isPrismatic(mechanism, joint) ? kLinear : Units{};
}

Units unitsOf(const Diagnosis& diagnosis, int joint) {
  return unitsOf(diagnosis.extended.mechanism, joint);
}

ParameterName splitName(std::string_view name, const Units& units) {
  if (name == "phase_rad") {
    return {.words = "phase", .unit = "rad"};  // of whatever repeats
  }
  for (const UnitEnding& unit : kUnits) {
    if (name.size() > unit.ending.size() && name.ends_with(unit.ending)) {
      return {.words = words(name.substr(0, name.size() - unit.ending.size())),
              .unit = std::string(units.position == "m" ? unit.linear : unit.rotating)};
    }
  }
  return {.words = words(name), .unit = {}};
}

std::string effectWords(std::string_view label) {
  std::string text;
  while (!label.empty()) {
    const std::size_t end = std::min(label.find('+'), label.size());
    const std::string_view part = label.substr(0, end);
    const std::size_t at = std::min(part.find('@'), part.size());
    text += (text.empty() ? "" : " + ") + words(part.substr(0, at));
    if (at < part.size()) {
      text += " on joint " + std::string(part.substr(at + 1));
    }
    label.remove_prefix(std::min(end + 1, label.size()));
  }
  return text;
}

std::string effectWords(const EffectFinding& effect) {
  return effectWords(effect.kind + "@" + std::to_string(effect.joint + 1));
}

std::string parameterWords(std::string_view name, const Units& units) {
  if (const std::size_t space = name.find(' '); space != std::string_view::npos) {
    return effectWords(name.substr(0, space)) + ": " + splitName(name.substr(space + 1), units).words;
  }
  const std::size_t index = std::min(name.find('['), name.size());
  const std::string text = splitName(name.substr(0, index), units).words;
  return index < name.size() ? text + " " + std::string(name.substr(index)) : text;
}

std::string valueWithInterval(double value, const std::array<double, 2>& interval) {
  const double width = interval[1] - interval[0];
  if (!(width > 0.0) || !std::isfinite(value)) {
    return shortNumber(value);
  }
  // Known up to a factor: each limit has digits of its own, as long as they need no exponent.
  constexpr double kLopsided = 2.0, kSmallest = 1e-5;
  if (interval[0] > kSmallest && interval[1] - value > kLopsided * (value - interval[0])) {
    return fmt::format("{} [{}, {}]", twoDigits(value), twoDigits(interval[0]), twoDigits(interval[1]));
  }
  // The first digit of the half width, two of them below 3.
  const int decimals = -static_cast<int>(std::floor(std::log10(0.5 * width / 3.0)));
  constexpr int kMostDecimals = 6;
  if (decimals > kMostDecimals) {
    return fmt::format("{:.4g} [{:.4g}, {:.4g}]", value, interval[0], interval[1]);
  }
  // A value within its own uncertainty has a digit all the same, where two more places show one.
  constexpr int kMorePlaces = 2;
  int shown = std::max(decimals, 0);
  const int first_digit = value == 0.0 ? 0 : -static_cast<int>(std::floor(std::log10(std::abs(value))));
  if (first_digit <= shown + kMorePlaces) {
    shown = std::max(shown, first_digit);
  }
  return fmt::format("{:.{}f} [{:.{}f}, {:.{}f}]", value, shown, interval[0], shown, interval[1], shown);
}

std::string estimateText(const ParameterEstimate& estimate, const Units& units) {
  const ParameterName name = splitName(estimate.name, units);
  return name.words + " " + valueWithInterval(estimate.value, estimate.ci95) +
         (name.unit.empty() ? "" : " " + name.unit);
}

std::string torqueErrorText(const EffectFinding& effect) {
  const bool is_known = effect.torque_error && *effect.torque_error < 1.0;
  return is_known ? fmt::format(", its torque within {:.2g} %", kPercent * *effect.torque_error)
                  : std::string();
}

std::string shortNumber(double value) {
  return std::isfinite(value) ? fmt::format("{:.3g}", value) : "–";
}

std::string numberAt(const std::vector<double>& values, std::size_t joint) {
  return joint < values.size() ? shortNumber(values[joint]) : "–";
}

std::array<double, 2> physicalRange(std::string_view kind, std::string_view name) {
  if (const model::EffectDescriptor* descriptor = model::findEffect(kind)) {
    for (const model::EffectParameter& parameter : descriptor->parameters) {
      if (parameter.name == name) {
        return {parameter.minimum, parameter.maximum};
      }
    }
  }
  return {-std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
}

std::string_view verdictWords(Verdict verdict) noexcept {
  switch (verdict) {
    case Verdict::kEffectFound:
      return "Missing effect found";
    case Verdict::kNothingMissing:
      return "Nothing is missing";
    case Verdict::kUnknownEffect:
      return "Something unknown is missing";
    case Verdict::kInsufficientExcitation:
      return "The motion is too poor to tell";
  }
  return "";
}

}  // namespace patella::diagnose
