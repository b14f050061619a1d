#include "tools/diagnose/verdict/excitation.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <set>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "tools/diagnose/checks/reading.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/detector.hpp"

namespace patella::diagnose {
namespace {

// Smallest torque, in units of the noise, at which each kind on each joint would show.
std::map<std::string, double> smallestOf(const Detector& detector, const Atoms& atoms) {
  std::map<std::string, std::vector<const Atom*>> by_label;
  for (const Atom& atom : atoms.items) {
    by_label[atom.label].push_back(&atom);
  }
  std::map<std::string, double> smallest;
  for (const auto& [label, points] : by_label) {
    double best = std::numeric_limits<double>::infinity();
    for (const Atom* point : someAtoms(points)) {
      best = std::min(best, detector.of(atoms.of(*point), point->joint).in_noise);
    }
    smallest[label] = best;
  }
  return smallest;
}

bool isDeclared(const ModelFit& fit, const ElementaryColumn& effect) {
  return std::any_of(fit.terms.begin(), fit.terms.end(), [&](const Term& term) {
    const auto& contains = term.recipe->contains;
    return term.declared && term.recipe->joint == effect.joint &&
           (term.recipe->kind == effect.kind ||
            std::find(contains.begin(), contains.end(), effect.kind) != contains.end());
  });
}

struct PlainEffects {
  std::size_t looked_for = 0;
  std::size_t unseen = 0;
};

// Nothing has to show of what is allowed to be left where nothing is missing, nor of what the model has
// already.
PlainEffects plainEffects(const Detector& detector, const Dataset& data, const ModelFit& fit) {
  const Column torque = data.driveTorque();
  PlainEffects result;
  for (const ElementaryColumn& effect : elementaryColumns(data)) {
    if (isDeclared(fit, effect)) {
      continue;
    }
    Eigen::MatrixXd columns = effect.torque;
    if (effect.kind == "linear_stiffness") {
      // Where the spring rests is free.
      columns.conservativeResize(Eigen::NoChange, 2);
      columns.col(1).setZero();
      columns.col(1).segment(effect.joint * data.rows(), data.rows()).setOnes();
    }
    const double allowed = unknown::kRestOfNothing * jointRms(data, torque, effect.joint) /
                           jointRms(data, fit.residual, effect.joint);
    const bool shows =
        detector.of(columns, effect.joint).in_noise <= std::max(motion::kPlainStrength, allowed);
    ++result.looked_for;
    result.unseen += shows ? 0 : 1;
  }
  return result;
}

bool singleSinusoids(std::span<const JointSignals> signals) {
  return std::all_of(signals.begin(), signals.end(), [](const JointSignals& joint) {
    return !joint.moves || joint.line_share > motion::kSingleLine;
  });
}

// "Joint 2 does not move"; empty where all do.
std::string restingJoints(std::span<const JointSignals> signals) {
  std::string resting;
  for (std::size_t j = 0; j < signals.size(); ++j) {
    if (!signals[j].moves) {
      resting += fmt::format("{} {}", resting.empty() ? "Joint" : " and joint", j + 1);
    }
  }
  return resting.empty() ? resting : resting + " does not move";
}

// A joint of which hardly any of the effects that were looked for would show; nothing where there is none.
std::optional<std::size_t> untoldJoint(const Excitation& excitation, std::size_t joints) {
  const auto count = [](const std::vector<std::string>& labels, std::size_t joint) {
    const std::string end = fmt::format("@{}", joint + 1);
    return static_cast<double>(std::count_if(labels.begin(), labels.end(),
                                             [&](const std::string& label) { return label.ends_with(end); }));
  };
  for (std::size_t j = 0; j < joints; ++j) {
    const double untold = count(excitation.not_identifiable, j);
    if (untold > 0.0 && untold > motion::kNearlyAll * (untold + count(excitation.identifiable, j))) {
      return j;
    }
  }
  return std::nullopt;
}

}  // namespace

std::string obstacle(std::span<const JointSignals> signals, const Dataset& data,
                     const model::ModelDescription& model) {
  if (std::none_of(signals.begin(), signals.end(), [](const JointSignals& joint) { return joint.moves; })) {
    return "No joint moves: velocities and ranges are those of encoders at rest.";
  }
  const Reader reader(data, model);
  const Reading reading = reader.asGiven();
  const model::DynamicsModel dynamics = model::makeModel(model);
  const Column inertial = data.column([&](const Series& series, std::size_t i) -> JointVector {
    return dynamics.mechanism().inertia(series.states[i].q) * series.acceleration[i];
  });
  for (int joint = 0; joint < data.joints(); ++joint) {
    const JointSignals& one = signals[static_cast<std::size_t>(joint)];
    const double missing_Nm =
        reading.error_with_effects[static_cast<std::size_t>(joint)] * reader.load_Nm(joint);
    if (one.constant_torque && one.moves &&
        missing_Nm > motion::kFreeSwing * jointRms(data, inertial, joint)) {
      return fmt::format(
          "The torque of joint {} never changes, though its motion takes {:.3g} {} more or less than what "
          "friction, a spring and other masses could make of it.",
          joint + 1, missing_Nm, unitsOf(model.mechanism, joint).torque);
    }
    if (one.clipped_share > motion::kMostClipped) {
      return fmt::format(
          "The torque of joint {} is cut off at {:.4g} {} in {:.0f} % of the rows: what acted there "
          "is not known.",
          joint + 1, one.clipped_Nm, unitsOf(model.mechanism, joint).torque, kPercent * one.clipped_share);
    }
  }
  return {};
}

void describeMotion(std::span<const JointSignals> signals, Diagnosis& diagnosis) {
  for (std::size_t j = 0; j < signals.size(); ++j) {
    const JointSignals& joint = signals[j];
    diagnosis.excitation.position_range_rad.push_back(joint.position_range_rad);
    diagnosis.excitation.velocity_rms_rad_s.push_back(joint.velocity_rms_rad_s);
    if (!joint.moves) {
      diagnosis.excitation.not_identifiable.push_back(fmt::format("joint {} is at rest", j + 1));
      diagnosis.warnings.push_back(
          fmt::format("joint {} is at rest: nothing that acts on it can be told", j + 1));
    } else if (joint.line_share > motion::kSingleLine) {
      diagnosis.warnings.push_back(fmt::format(
          "a single sinusoid of {:.3g} Hz excites joint {}: what is proportional to position, velocity or "
          "acceleration cannot be told apart for certain; add a second frequency",
          joint.line_Hz, j + 1));
    }
    if (joint.clipped_share > motion::kLeastClipped) {
      diagnosis.warnings.push_back(fmt::format(
          "the torque of joint {} is cut off at {:.4g} {} in {:.1f} % of the rows", j + 1, joint.clipped_Nm,
          unitsOf(diagnosis, static_cast<int>(j)).torque, kPercent * joint.clipped_share));
    }
  }
}

void judgeExcitation(std::span<const JointSignals> signals, const Dataset& data, const ModelFit& fit,
                     const Atoms& atoms, Diagnosis& diagnosis) {
  const Detector detector(data, fit, thresholdOf(diagnosis, fit));
  std::set<std::string> found;
  for (const EffectFinding& effect : diagnosis.effects) {
    found.insert(fmt::format("{}@{}", effect.kind, effect.joint + 1));
  }
  for (const auto& [label, smallest] : smallestOf(detector, atoms)) {
    const bool shows = found.contains(label) || smallest < 1.0;
    (shows ? diagnosis.excitation.identifiable : diagnosis.excitation.not_identifiable).push_back(label);
  }
  for (const RefittedParameter& parameter : diagnosis.nominal) {
    const bool narrowed = parameter.sd < motion::kNarrowed * parameter.known_sd;
    (narrowed ? diagnosis.excitation.identifiable : diagnosis.excitation.not_identifiable)
        .push_back("nominal " + parameter.name);
  }

  const Column torque = data.driveTorque();
  for (int joint = 0; joint < data.joints(); ++joint) {
    const auto j = static_cast<std::size_t>(joint);
    const RestOfJoint& rest = diagnosis.rests[j];
    if (!signals[j].moves && !data.isStatic() && rest.structure_Nm > unknown::kLikeNoise * rest.noise_Nm &&
        jointRms(data, fit.residual, joint) > motion::kRestExplained * jointRms(data, torque, joint)) {
      diagnosis.doubts.push_back(
          {Doubt::kRestingTorque,
           fmt::format("Joint {} is at rest by its encoder, but its torque is not what would hold it there; "
                       "what moves the others cannot be told either.",
                       joint + 1)});
      return;
    }
  }
  if (data.isStatic()) {
    return;
  }
  if (diagnosis.effects.size() > 1 && singleSinusoids(signals)) {
    diagnosis.doubts.push_back(
        {Doubt::kSingleSinusoids,
         "Single sinusoids excite the joints, and more than one effect would be needed: other combinations "
         "explain as much. Add a second frequency."});
  }
  if (const std::string resting = restingJoints(signals); !resting.empty()) {
    diagnosis.doubts.push_back(
        {Doubt::kJointAtRest, fmt::format("{}: whether anything is missing there cannot be told. Nothing was "
                                          "found to be missing elsewhere.",
                                          resting)});
  }
  if (const auto joint = untoldJoint(diagnosis.excitation, signals.size())) {
    diagnosis.doubts.push_back(
        {Doubt::kJointUntold,
         fmt::format("Next to nothing that acts on joint {} would show: too little motion, or too much that "
                     "is not explained. Nothing was found.",
                     *joint + 1)});
  }
  const PlainEffects plain = plainEffects(detector, data, fit);
  if (static_cast<double>(plain.unseen) > motion::kMostPlainUnseen * static_cast<double>(plain.looked_for)) {
    diagnosis.doubts.push_back(
        {Doubt::kPlainEffectsUnseen,
         fmt::format("Nothing was found, but of {} plain effects {} would not show if they were three "
                     "times as large as the noise, or a twentieth of their joint's torque.",
                     plain.looked_for, plain.unseen)});
  }
}

}  // namespace patella::diagnose
