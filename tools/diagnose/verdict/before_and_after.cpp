#include "tools/diagnose/verdict/before_and_after.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "tools/diagnose/fit/model_error.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

void addCurves(const Dataset& train, const std::optional<Dataset>& heldout,
               const model::ModelDescription& given, Diagnosis& result) {
  result.simulation_window_s = kSimulationWindow_s;
  result.curves_rate_Hz = train.rate_Hz();
  appendCurves(train, given, result.extended, false, result.curves);
  if (heldout) {
    appendCurves(*heldout, given, result.extended, true, result.curves);
  }
}

// Compares the model's errors on held-out data; `unit_Nm` is each joint's.
bool isWorse(const Diagnosis& result, const std::vector<double>& unit_Nm) {
  double more = 0.0;
  for (std::size_t joint = 0; joint < unit_Nm.size(); ++joint) {
    const double unit = unit_Nm[joint] > 0.0 ? unit_Nm[joint] : 1.0;
    more += std::pow(result.after.heldout_rms_Nm[joint] / unit, 2) -
            std::pow(result.before.heldout_rms_Nm[joint] / unit, 2);
  }
  return more > 0.0;
}

// Effects that do not hold on held-out data are not added. A hip's noise is several times a knee's,
// so joints count in units of theirs. Where nothing was named to explain it, what a fit leaves may be no
// noise: refitted parameters then have to hold in plain torque, too. Returns the errors by which the held-out
// part is to be compared with the fitted one: those of parameters that do not hold tell what they met there.
ErrorMeasure keepOnlyWhatHolds(const model::ModelDescription& given, Diagnosis& result) {
  // A finding that the model does not hold, such as a tremor whose phase wanders, has made nothing worse.
  const auto was_added = [&result](const EffectFinding& finding) {
    return std::any_of(result.extended.effects.begin(), result.extended.effects.end(),
                       [&](const model::EffectDescription& effect) {
                         return effect.kind == finding.kind && effect.joint == finding.joint;
                       });
  };
  const bool any_added = std::any_of(result.effects.begin(), result.effects.end(), was_added);
  const std::vector<double> plain(result.noise_floor_Nm.size(), 1.0);
  if (!isWorse(result, result.noise_floor_Nm) && (any_added || !isWorse(result, plain))) {
    return result.after;
  }
  const ErrorMeasure told = any_added ? result.before : result.after;
  if (any_added) {
    std::erase_if(result.effects, was_added);
    result.doubts.push_back(
        {Doubt::kHeldOutWorse,
         "What explained the first part of the recording makes the error of the held-out part larger; "
         "the model is left as it was."});
  } else {
    std::erase_if(result.doubts, [](const Doubt& doubt) { return doubt.kind == Doubt::kParametersMoved; });
    result.warnings.emplace_back(
        "refitted nominal parameters make the held-out error larger; the model is left as it was");
  }
  result.extended = given;
  result.after = result.before;
  return told;
}

// Joints share a mechanism: what helps them together may cost one of them.
void tellWhichJointPays(Diagnosis& result) {
  for (std::size_t joint = 0; joint < result.after.heldout_rms_Nm.size(); ++joint) {
    const double before = result.before.heldout_rms_Nm[joint];
    const double after = result.after.heldout_rms_Nm[joint];
    if (after > held_out::kCost * before) {
      result.warnings.push_back(fmt::format(
          "the held-out error of joint {} grows from {:.3g} to {:.3g} {}, while that of all together falls",
          joint + 1, before, after, unitsOf(result, static_cast<int>(joint)).torque));
    }
  }
}

// Torque of a joint, rms, of which an error makes this share.
double torqueOf(double error_Nm, double share) {
  return error_Nm / std::max(share, 1e-300);
}

// An error of the model grows with the motion, as that of a sweep does towards its end. It is no event, as
// long as it is a small share of the torque.
bool growsWithTorque(const ErrorMeasure& error, std::size_t joint, double fitted_Nm, double unseen_Nm) {
  const double of_fitted_Nm = torqueOf(error.train_rms_Nm[joint], error.train_relative[joint]);
  const double of_unseen_Nm = torqueOf(error.heldout_rms_Nm[joint], error.heldout_relative[joint]);
  return unseen_Nm < unknown::kRestOfNothing * of_unseen_Nm &&
         unseen_Nm * of_fitted_Nm < held_out::kOutOfProportion * fitted_Nm * of_unseen_Nm;
}

// Nobody misses less.
bool isNextToNothing(const ErrorMeasure& error, std::size_t joint, double unseen_Nm) {
  return unseen_Nm <
         unknown::kLeastOfLoad * torqueOf(error.heldout_rms_Nm[joint], error.heldout_relative[joint]);
}

// What was found is not quite nature's effect, and the rest of that shows where it is large.
bool isLittleOfWhatWasFound(const Diagnosis& result, std::size_t joint, double unseen_Nm) {
  return unseen_Nm < held_out::kLittleOfFound * result.refitted.heldout_rms_Nm[joint];
}

// An event of the held-out part alone has left no trace in the fitted one.
void compareParts(const ErrorMeasure& error, Diagnosis& result) {
  for (std::size_t joint = 0; joint < result.noise_floor_Nm.size(); ++joint) {
    const double fitted = std::max(result.noise_floor_Nm[joint], error.train_rms_Nm[joint]);
    const double unseen = error.heldout_rms_Nm[joint];
    if (fitted > 0.0 && unseen > held_out::kOutOfProportion * fitted &&
        !isNextToNothing(result.before, joint, unseen) && !isLittleOfWhatWasFound(result, joint, unseen) &&
        !growsWithTorque(result.before, joint, fitted, unseen)) {
      result.unexplained.push_back({.joint = static_cast<int>(joint),
                                    .variable = "time",
                                    .explained_Nm = std::sqrt(unseen * unseen - fitted * fitted)});
      result.doubts.push_back(
          {Doubt::kHeldOutDiffers,
           fmt::format("Something else happens in the held-out part: the error of joint {} is {:.1f} times "
                       "what it was in the part that was fitted.",
                       joint + 1, unseen / fitted)});
      return;
    }
  }
}

}  // namespace

void judgeByErrors(const BeforeAndAfter& models, Diagnosis& result) {
  result.extended = models.extended;
  result.before = errorMeasure(models.train, models.heldout, models.given);
  result.refitted = errorMeasure(models.train, models.heldout, models.refitted);
  result.after = errorMeasure(models.train, models.heldout, result.extended);
  for (int joint = 0; joint < models.train.joints(); ++joint) {
    result.noise_floor_Nm.push_back(jointRms(models.train, models.unexplained, joint));
  }
  if (models.heldout) {
    const ErrorMeasure told = keepOnlyWhatHolds(models.given, result);
    tellWhichJointPays(result);
    compareParts(told, result);
  }
  addCurves(models.train, models.heldout, models.given, result);
}

void leaveAsItWas(const Dataset& train, const std::optional<Dataset>& heldout,
                  const model::ModelDescription& given, Diagnosis& result) {
  result.extended = given;
  result.before = errorMeasure(train, heldout, given);
  result.refitted = result.before;
  result.after = result.before;
  result.noise_floor_Nm = result.before.train_rms_Nm;
  addCurves(train, heldout, given, result);
}

}  // namespace patella::diagnose
