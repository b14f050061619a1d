#include "tools/diagnose/output/residual_variables.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "core/model/effect.hpp"
#include "tools/diagnose/effects/effect_home.hpp"
#include "tools/diagnose/output/residual_analysis.hpp"
#include "tools/diagnose/result/parameter_text.hpp"

namespace patella::diagnose {
namespace {

/// A longer pause between stretches is drawn as one of this length.
constexpr double kPause_s = 0.5;

const JointCurves& curvesOf(const Diagnosis& diagnosis, int joint) {
  return diagnosis.curves[static_cast<std::size_t>(joint)];
}

/// The effect in the extended model, or nullptr. What was found stands behind what was declared.
const model::EffectDescription* extendedBy(const Diagnosis& diagnosis, const EffectFinding& finding) {
  const auto& effects = diagnosis.extended.effects;
  const auto found =
      std::find_if(effects.rbegin(), effects.rend(), [&](const model::EffectDescription& effect) {
        return effect.kind == finding.kind && effect.joint == finding.joint;
      });
  return found == effects.rend() ? nullptr : &*found;
}

/// EMG channel of an effect, from 0. It is no estimate, so that only the extended model tells it.
int channelOf(const Diagnosis& diagnosis, const EffectFinding& finding) {
  const model::EffectDescription* effect = extendedBy(diagnosis, finding);
  const model::EffectDescriptor* descriptor = model::findEffect(finding.kind);
  for (std::size_t i = 0; effect != nullptr && i < effect->parameters.size(); ++i) {
    if (descriptor->parameters[i].name == "channel") {
      return static_cast<int>(effect->parameters[i]) - 1;
    }
  }
  return 0;
}

/// By central differences within the stretches, one-sided at their ends.
std::vector<double> slopeOf(const std::vector<double>& values, const std::vector<Segment>& stretches,
                            double rate_Hz) {
  std::vector<double> slope(values.size(), std::nan(""));
  for (const Segment& stretch : stretches) {
    for (std::size_t i = stretch.first; i < stretch.end && stretch.end - stretch.first > 1; ++i) {
      const std::size_t before = i > stretch.first ? i - 1 : i;
      const std::size_t after = i + 1 < stretch.end ? i + 1 : i;
      slope[i] = (values[after] - values[before]) * rate_Hz / static_cast<double>(after - before);
    }
  }
  return slope;
}

}  // namespace

Layout layoutOf(const JointCurves& curves, double rate_Hz) {
  Layout layout{.time_s = curves.time_s, .stretches = stretchesOf(curves.time_s, rate_Hz)};
  double shift_s = 0.0;
  for (std::size_t s = 1; s < layout.stretches.size(); ++s) {
    const Segment& stretch = layout.stretches[s];
    const double pause_s = curves.time_s[stretch.first] - curves.time_s[stretch.first - 1];
    if (pause_s < 0.0 || pause_s > 2.0 * kPause_s) {
      shift_s = layout.time_s[stretch.first - 1] + kPause_s - curves.time_s[stretch.first];
    }
    for (std::size_t i = stretch.first; i < stretch.end; ++i) {
      layout.time_s[i] += shift_s;
    }
  }
  return layout;
}

bool isAtRest(const Diagnosis& diagnosis) {
  return std::all_of(diagnosis.curves.begin(), diagnosis.curves.end(), [](const JointCurves& curves) {
    return std::all_of(curves.velocity_rad_s.begin(), curves.velocity_rad_s.end(),
                       [](double velocity) { return velocity == 0.0; });
  });
}

Variable betrayedBy(const Diagnosis& diagnosis, const EffectFinding& finding) {
  Variable variable{.kind = effectHome(finding.kind).shows, .index = finding.joint};
  if (variable.kind == Variable::Kind::kTime) {
    variable.index = 0;
  }
  if (variable.kind == Variable::Kind::kActivation) {
    variable.index = channelOf(diagnosis, finding);
  }
  return variable;
}

std::optional<Variable> variableNamed(std::string_view name) {
  using Kind = Variable::Kind;
  static constexpr std::array<std::pair<std::string_view, Kind>, 6> kStems{
      {{"ddq", Kind::kAcceleration},
       {"dq", Kind::kVelocity},
       {"q", Kind::kPosition},
       {"tau", Kind::kTorque},
       {"time", Kind::kTime},
       {"activation", Kind::kActivation}}};
  const std::string_view first = name.substr(0, name.find('*'));
  for (const auto& [stem, kind] : kStems) {
    if (!first.starts_with(stem)) {
      continue;
    }
    const std::string_view number = first.substr(stem.size());
    if (number.empty()) {
      return Variable{.kind = kind, .index = 0};
    }
    if (number.size() == 1 && number.front() >= '1' && number.front() <= '9') {
      return Variable{.kind = kind, .index = number.front() - '1'};
    }
  }
  return std::nullopt;
}

NamedValues valuesOf(const Diagnosis& diagnosis, const Variable& variable, const Layout& layout) {
  using Kind = Variable::Kind;
  if (variable.kind == Kind::kTime) {
    return {"time / s", layout.time_s};
  }
  if (variable.kind == Kind::kActivation) {
    const auto& channels = diagnosis.curves.front().activation;
    return {fmt::format("activation of EMG channel {}", variable.index + 1),
            static_cast<std::size_t>(variable.index) < channels.size()
                ? channels[static_cast<std::size_t>(variable.index)]
                : std::vector<double>()};
  }
  if (static_cast<std::size_t>(variable.index) >= diagnosis.curves.size()) {
    return {};
  }
  const JointCurves& curves = curvesOf(diagnosis, variable.index);
  const Units units = unitsOf(diagnosis, variable.index);
  const std::string of = fmt::format(" of joint {} / ", variable.index + 1);
  switch (variable.kind) {
    case Kind::kPosition:
      return {"position" + of + units.position, curves.position_rad};
    case Kind::kAcceleration:
      return {"acceleration" + of + units.position + "/s²", curves.acceleration_rad_s2};
    case Kind::kTorque:
      return {"torque" + of + units.torque, curves.torque_Nm};
    case Kind::kTorqueRate:
      return {"rate of torque" + of + units.torque + "/s",
              slopeOf(curves.torque_Nm, layout.stretches, diagnosis.curves_rate_Hz)};
    default:
      return {"velocity" + of + units.position + "/s", curves.velocity_rad_s};
  }
}

std::vector<double> shareOf(const Diagnosis& diagnosis, const EffectFinding& finding, const Layout& layout) {
  const model::EffectDescription* effect = extendedBy(diagnosis, finding);
  if (effect == nullptr) {
    return {};
  }
  model::DynamicsModel with =
      model::makeModel({.mechanism = diagnosis.extended.mechanism, .effects = {*effect}});
  const model::DynamicsModel without =
      model::makeModel({.mechanism = diagnosis.extended.mechanism, .effects = {}});
  const auto joints = static_cast<Eigen::Index>(diagnosis.curves.size());
  std::vector<double> share(layout.time_s.size());
  model::EffectInput state;
  state.q.resize(joints);
  state.dq.resize(joints);
  state.torque_Nm.resize(joints);
  JointVector acceleration(joints);
  for (const Segment& stretch : layout.stretches) {
    for (std::size_t i = stretch.first; i < stretch.end; ++i) {
      for (Eigen::Index joint = 0; joint < joints; ++joint) {
        const JointCurves& curves = diagnosis.curves[static_cast<std::size_t>(joint)];
        state.q[joint] = curves.position_rad[i];
        state.dq[joint] = curves.velocity_rad_s[i];
        state.torque_Nm[joint] = curves.torque_Nm[i];
        acceleration[joint] = curves.acceleration_rad_s2[i];
      }
      for (std::size_t c = 0; c < state.activation.size(); ++c) {
        const std::vector<double>& channel = diagnosis.curves.front().activation[c];
        state.activation[c] = channel.empty() ? 0.0 : channel[i];
      }
      state.time_s = diagnosis.curves.front().time_s[i];
      i == stretch.first ? with.reset(state) : with.advance(state, 1.0 / diagnosis.curves_rate_Hz);
      share[i] = (with.inverseDynamics(state, acceleration) -
                  without.inverseDynamics(state, acceleration))[finding.joint];
    }
  }
  return share;
}

}  // namespace patella::diagnose
