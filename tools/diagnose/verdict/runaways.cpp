#include "tools/diagnose/verdict/runaways.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include <fmt/format.h>

#include "core/model/effect.hpp"
#include "tools/diagnose/effects/declared.hpp"
#include "tools/diagnose/effects/effect_home.hpp"
#include "tools/diagnose/effects/recipe_parts.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::string label(const std::string& kind, int joint) {
  return fmt::format("{}@{}", kind, joint + 1);
}

std::string withUnit(double value, const std::string& unit) {
  return fmt::format("{:.4g}{}{}", value, unit.empty() ? "" : " ", unit);
}

// The larger one of the fitted and the held-out data.
void addErrors(const char* model, const ErrorMeasure& error, std::vector<Runaway>& all) {
  for (std::size_t joint = 0; joint < error.train_relative.size(); ++joint) {
    const bool heldout =
        joint < error.heldout_relative.size() && error.heldout_relative[joint] > error.train_relative[joint];
    const double relative = (heldout ? error.heldout_relative : error.train_relative)[joint];
    const double rms = (heldout ? error.heldout_rms_Nm : error.train_rms_Nm)[joint];
    if (relative > 1.0 && relative < runaway::kNoTorque) {
      all.push_back(
          {.what = fmt::format("error@{}", joint + 1),
           .nominal = rms / relative,
           .refitted = rms,
           .limit = 1.0,
           .words = fmt::format("the error of joint {}, {}{}, is larger than its torque ({:.0f} %): "
                                "no model at all would do better",
                                joint + 1, model, heldout ? ", on held-out data" : "", kPercent * relative)});
    }
  }
}

// Knowledge of a parameter beside its physical range.
struct Standing {
  std::array<double, 2> range{};
  bool anything = false;  ///< its interval holds the whole range
  bool at_low = false, at_high = false;
  bool holds_zero = false;
};

Standing standingOf(const std::array<double, 2>& range, const ParameterEstimate& estimate) {
  const double from = estimate.ci95[0], to = estimate.ci95[1];
  const auto touches = [&](double bound) {
    return std::isfinite(bound) && std::abs(estimate.value - bound) <=
                                       runaway::kTouches * std::max(std::abs(bound), 0.5 * (to - from));
  };
  return {.range = range,
          .anything = from < to && from <= range[0] && to >= range[1],
          .at_low = touches(range[0]),
          .at_high = touches(range[1]),
          .holds_zero = from < 0.0 && to > 0.0};
}

void addEstimate(const EffectFinding& effect, const ParameterEstimate& estimate, const Units& units,
                 std::vector<Runaway>& all) {
  const Standing stands = standingOf(physicalRange(effect.kind, estimate.name), estimate);
  const auto [low, high] = stands.range;
  const std::string unit = splitName(estimate.name, units).unit;
  const std::string what = label(effect.kind, effect.joint) + " " + estimate.name;
  const auto add = [&](double limit, const std::string& words) {
    all.push_back({.what = what,
                   .nominal = kNone,
                   .refitted = estimate.value,
                   .limit = limit,
                   .words = parameterWords(what, units) + " " + words});
  };
  if (stands.anything) {
    add(kNone, fmt::format("may be anything: the interval holds its whole range, {} to {}",
                           withUnit(low, unit), withUnit(high, unit)));
    return;
  }
  if (stands.at_low || stands.at_high) {
    const double bound = stands.at_low ? low : high;
    add(bound, fmt::format("stands at {}, the end of its range", withUnit(bound, unit)));
  } else if (estimate.at_bound) {
    add(estimate.value, fmt::format("stands at {}, where the search ends", withUnit(estimate.value, unit)));
  }
  if (stands.holds_zero && (low >= 0.0 || isStrength(effect.kind, estimate.name))) {
    add(0.0, fmt::format("{}{}{} may be zero", valueWithInterval(estimate.value, estimate.ci95),
                         unit.empty() ? "" : " ", unit));
  }
}

// "(+25 %), outside its tolerance of -18 to +22 %", or of its limits where it has no ratio.
std::string beyondWords(const RefittedParameter& parameter, const std::string& unit) {
  const auto [low, high] = parameter.tolerated;
  if (!parameter.is_ratio) {
    return fmt::format("outside its tolerance of {} to {}", withUnit(low, ""), withUnit(high, unit));
  }
  const auto change = [&](double value) { return kPercent * (value / parameter.nominal - 1.0); };
  return fmt::format("({:+.0f} %), outside its tolerance of {:.0f} to {:+.0f} %", change(parameter.refitted),
                     change(low), change(high));
}

void addNominal(const RefittedParameter& parameter, double tolerance, const Units& units,
                std::vector<Runaway>& all) {
  if (!parameter.isBeyond()) {
    return;
  }
  const std::string unit = splitName(parameter.name.substr(0, parameter.name.find('[')), units).unit;
  const double bound = parameter.tolerated[parameter.refitted > parameter.nominal ? 1 : 0];
  all.push_back(
      {.what = parameter.name,
       .nominal = parameter.nominal,
       .refitted = parameter.refitted,
       .limit = parameter.is_ratio ? runaway::kWithinTolerance * tolerance : bound,
       .words = fmt::format("the model's {} went from {} to {}{}{}", parameterWords(parameter.name, units),
                            withUnit(parameter.nominal, ""), withUnit(parameter.refitted, unit),
                            parameter.is_ratio ? " " : ", ", beyondWords(parameter, unit))});
}

/// The declared effect in the extended model; several of a kind on one joint keep their order. Nothing where
/// it is gone.
const model::EffectDescription* stillIn(std::span<const model::EffectDescription> extended,
                                        std::span<const model::EffectDescription> declared,
                                        std::size_t index) {
  const auto same = [&](const model::EffectDescription& effect) {
    return effect.kind == declared[index].kind && effect.joint == declared[index].joint;
  };
  auto before = std::count_if(declared.begin(), declared.begin() + static_cast<std::ptrdiff_t>(index), same);
  for (const model::EffectDescription& effect : extended) {
    if (same(effect) && before-- == 0) {
      return &effect;
    }
  }
  return nullptr;
}

/// The effect that stands in a declared one's place.
const EffectFinding* replacementOf(const Diagnosis& diagnosis, const model::EffectDescription& declared) {
  const auto found =
      std::find_if(diagnosis.effects.begin(), diagnosis.effects.end(), [&](const EffectFinding& effect) {
        return effect.joint == declared.joint && std::find(effect.replaces.begin(), effect.replaces.end(),
                                                           declared.kind) != effect.replaces.end();
      });
  return found == diagnosis.effects.end() ? nullptr : &*found;
}

void addDeclared(const Diagnosis& diagnosis, const model::ModelDescription& given, std::size_t index,
                 double tolerance, std::vector<Runaway>& all) {
  const model::EffectDescription& declared = given.effects[index];
  const std::string what = label(declared.kind, declared.joint);
  const EffectFinding* replacement = replacementOf(diagnosis, declared);
  const model::EffectDescription* kept = stillIn(diagnosis.extended.effects, given.effects, index);
  if (replacement != nullptr || kept == nullptr) {
    all.push_back(
        {.what = what,
         .nominal = kNone,
         .refitted = kNone,
         .limit = kNone,
         .words = "the declared " + effectWords(what) + " vanished" +
                  (replacement == nullptr ? "" : ": " + effectWords(*replacement) + " takes its place")});
    return;
  }
  const auto& parameters = model::findEffect(declared.kind)->parameters;
  for (std::size_t p = 0; p < declared.parameters.size(); ++p) {
    if (parameters[p].name == kSmoothing) {
      continue;  // a warning tells of that
    }
    const double before = declared.parameters[p];
    const double after = kept->parameters[p];
    const ParameterName name = splitName(parameters[p].name, unitsOf(diagnosis, declared.joint));
    const bool nothing_left = std::abs(after) < runaway::kNothingLeft * std::abs(before);
    if (nothing_left || std::abs(after - before) > runaway::kWithinTolerance * tolerance * std::abs(before)) {
      all.push_back({.what = what + " " + std::string(parameters[p].name),
                     .nominal = before,
                     .refitted = after,
                     .limit = runaway::kWithinTolerance * tolerance,
                     .words = fmt::format("the declared {}: {} {} from {} to {}", effectWords(what),
                                          name.words, nothing_left ? "vanished" : "went",
                                          withUnit(before, ""), withUnit(after, name.unit)) +
                              (nothing_left ? ""
                                            : fmt::format(" ({:+.0f} %), beyond its tolerance of {:.0f} %",
                                                          kPercent * (after / before - 1.0),
                                                          kPercent * runaway::kWithinTolerance * tolerance)),
                     .resized = true});
    }
  }
}

}  // namespace

bool strengthIsUnknown(const EffectFinding& effect) {
  if (effect.torque_error) {
    return *effect.torque_error >= 1.0;
  }
  const auto tellsStrength = [&](const ParameterEstimate& estimate) {
    return isStrength(effect.kind, estimate.name);
  };
  const bool has_strengths = std::any_of(effect.parameters.begin(), effect.parameters.end(), tellsStrength);
  for (const ParameterEstimate& estimate : effect.parameters) {
    // No part of this variant of the kind.
    if (has_strengths && estimate.value == 0.0 && estimate.ci95[0] == 0.0 && estimate.ci95[1] == 0.0) {
      continue;
    }
    // An effect without a strength is as large as its first parameter says.
    const bool counts = has_strengths ? tellsStrength(estimate) : &estimate == &effect.parameters.front();
    const Standing stands = standingOf(physicalRange(effect.kind, estimate.name), estimate);
    if (counts && !stands.anything && !stands.at_low && !stands.at_high && !stands.holds_zero) {
      return false;
    }
  }
  return true;
}

bool periodsAreUnknown(const EffectFinding& effect, double joint_range) {
  return std::any_of(effect.parameters.begin(), effect.parameters.end(),
                     [=](const ParameterEstimate& estimate) {
                       return estimate.name == "cycles_per_rad" &&
                              0.5 * (estimate.ci95[1] - estimate.ci95[0]) * joint_range > 0.5;
                     });
}

bool mayBeAnother(const EffectFinding& effect) {
  return std::any_of(effect.parameters.begin(), effect.parameters.end(), [&](const auto& estimate) {
    return estimate.at_bound && estimate.name == effectHome(effect.kind).distinguished_by;
  });
}

std::vector<Runaway> runawaysOf(const Diagnosis& diagnosis, const model::ModelDescription& given,
                                const FitOptions& tolerances) {
  std::vector<Runaway> all;
  addErrors("of the model as given", diagnosis.before, all);
  if (diagnosis.after.train_rms_Nm != diagnosis.before.train_rms_Nm) {
    addErrors("with what was found", diagnosis.after, all);
  }
  const Units units = unitsOf(diagnosis);
  for (const EffectFinding& effect : diagnosis.effects) {
    for (const ParameterEstimate& estimate : effect.parameters) {
      if (estimate.name == kSmoothing) {
        continue;  // how friction turns round is how it is written
      }
      addEstimate(effect, estimate, unitsOf(diagnosis, effect.joint), all);
    }
  }
  for (const RefittedParameter& parameter : diagnosis.nominal) {
    addNominal(parameter, tolerances.nominal_tolerance, units, all);
  }
  for (std::size_t i = 0; i < given.effects.size(); ++i) {
    addDeclared(diagnosis, given, i, runaway::kTolerance, all);
  }
  return all;
}

}  // namespace patella::diagnose
