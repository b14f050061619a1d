#include "tools/bench/diagnose/planted.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "core/model/effect.hpp"
#include "tools/bench/diagnose/asserted.hpp"
#include "tools/bench/diagnose/measured_rigs.hpp"
#include "tools/bench/diagnose/random.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/evidence/decision.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::bench {
namespace {

using diagnose::Recording;
using diagnose::Segment;

/// Shortest part of a recording that is diagnosed.
constexpr double kShortest_s = 2.5;

/// Rows `from` … `to` (shares) of the longest stretch.
Recording part(const Recording& whole, double from, double to) {
  const Segment& longest =
      *std::max_element(whole.segments.begin(), whole.segments.end(),
                        [](const Segment& a, const Segment& b) { return a.end - a.first < b.end - b.first; });
  const auto length = static_cast<double>(longest.end - longest.first);
  Recording result = whole;
  result.segments = {{.first = longest.first + static_cast<std::size_t>(from * length),
                      .end = longest.first + static_cast<std::size_t>(to * length)}};
  return result;
}

struct Half {
  const MeasuredRecording* source = nullptr;
  double from = 0.0, to = 1.0;
  model::ModelDescription model;  ///< that the other half led to
};

struct Plant {
  std::string kind;
  int joint = 0;
  std::vector<double> parameters;
  double share = 0.0;  ///< rms of its torque over that of the rigid body
};

struct Size {
  double torque_Nm = 0.0, velocity_rad_s = 0.0, acceleration_rad_s2 = 0.0, middle_rad = 0.0, range_rad = 0.0;
};

Size sizeOf(const diagnose::Dataset& data, const model::DynamicsModel& dynamics, int joint) {
  Size size;
  double count = 0.0, low = 1e300, high = -1e300;
  for (const diagnose::Series& series : data.series()) {
    for (std::size_t i = 0; i < series.states.size(); ++i) {
      const model::EffectInput& state = series.states[i];
      const double torque = (dynamics.mechanism().regressor(state.q, state.dq, series.acceleration[i]) *
                             dynamics.mechanism().baseParameters())[joint];
      size.torque_Nm += torque * torque;
      size.velocity_rad_s += state.dq[joint] * state.dq[joint];
      size.acceleration_rad_s2 += series.acceleration[i][joint] * series.acceleration[i][joint];
      low = std::min(low, state.q[joint]);
      high = std::max(high, state.q[joint]);
      count += 1.0;
    }
  }
  for (double* square : {&size.torque_Nm, &size.velocity_rad_s, &size.acceleration_rad_s2}) {
    *square = std::sqrt(*square / count);
  }
  size.middle_rad = 0.5 * (low + high);
  size.range_rad = high - low;
  return size;
}

std::vector<double> parametersOf(const std::string& kind, const std::map<std::string, double>& wanted) {
  std::vector<double> values;
  for (const model::EffectParameter& parameter : model::findEffect(kind)->parameters) {
    const auto found = wanted.find(std::string(parameter.name));
    values.push_back(found == wanted.end() ? parameter.initial
                                           : std::clamp(found->second, parameter.minimum, parameter.maximum));
  }
  return values;
}

Plant drawPlant(const Size& size, int joint, Random& random) {
  constexpr std::array kKinds{"coulomb_friction", "viscous_friction", "linear_stiffness",
                              "torque_bias",      "rotor_inertia",    "torque_gain",
                              "actuator_lag",     "actuator_delay",   "asymmetric_friction"};
  Plant plant{.kind = kKinds[random.below(kKinds.size())],
              .joint = joint,
              .parameters = {},
              .share = random.logUniform(0.03, 0.5)};
  const double level_Nm = plant.share * size.torque_Nm;
  const double smoothing = 0.005 * size.velocity_rad_s;
  const double one_sided = random.uniform(0.3, 0.7);
  plant.parameters = parametersOf(
      plant.kind, {{"level_Nm", level_Nm},
                   {"smoothing_velocity_rad_s", smoothing},
                   {"coefficient_Nms_rad", level_Nm / size.velocity_rad_s},
                   {"stiffness_Nm_rad", 3.0 * level_Nm / size.range_rad},
                   {"rest_position_rad", size.middle_rad + random.uniform(-0.2, 0.2) * size.range_rad},
                   {"bias_Nm", random.sign() * level_Nm},
                   {"inertia_kg_m2", level_Nm / size.acceleration_rad_s2},
                   {"gain_error", random.sign() * random.uniform(0.05, 0.3)},
                   {"time_constant_s", random.logUniform(0.003, 0.03)},
                   {"delay_s", random.logUniform(0.003, 0.03)},
                   {"level_positive_Nm", 2.0 * one_sided * level_Nm},
                   {"level_negative_Nm", 2.0 * (1.0 - one_sided) * level_Nm},
                   {"viscous_positive_Nms_rad", 0.0},
                   {"viscous_negative_Nms_rad", 0.0}});
  return plant;
}

// What the drive would have had to give with the effect there and the motion the same.
void plantIn(Recording& recording, const Plant& plant, const model::Mechanism& mechanism) {
  constexpr double kEveryRow_Hz = 1e6;
  const diagnose::Dataset data(std::span(&recording, 1), {.evaluation_rate_Hz = kEveryRow_Hz});
  const auto effect = model::makeEffect(plant.kind, plant.joint, mechanism, plant.parameters);
  const auto j = static_cast<std::size_t>(plant.joint);
  const std::size_t first = recording.segments.front().first;
  const diagnose::Series& series = data.series().front();
  const auto torque = [&](std::size_t i, double later_s) {
    const double place = std::clamp(static_cast<double>(i) + later_s * series.rate_Hz, 0.0,
                                    static_cast<double>(series.states.size() - 1));
    const auto low = std::min(static_cast<std::size_t>(place), series.states.size() - 2);
    const double share = place - static_cast<double>(low);
    return (1.0 - share) * series.states[low].torque_Nm[plant.joint] +
           share * series.states[low + 1].torque_Nm[plant.joint];
  };
  std::vector<double> planted(series.states.size());
  effect->reset(series.states.front());
  for (std::size_t i = 0; i < planted.size(); ++i) {
    const double measured = recording.torque_Nm[j][first + i];
    if (plant.kind == "torque_gain") {
      planted[i] = measured / (1.0 + plant.parameters[0]);
    } else if (plant.kind == "actuator_delay") {
      planted[i] = measured + torque(i, plant.parameters[0]) - torque(i, 0.0);
    } else if (plant.kind == "actuator_lag") {
      const double step_s = 1.0 / series.rate_Hz;
      planted[i] = measured + plant.parameters[0] * (torque(i, step_s) - torque(i, -step_s)) / (2.0 * step_s);
    } else {
      if (i > 0) {
        effect->advance(series.states[i], 1.0 / series.rate_Hz);
      }
      planted[i] = measured + (effect->inertia(series.states[i].q) * series.acceleration[i] -
                               effect->torque(series.states[i]))[plant.joint];
    }
  }
  std::copy(planted.begin(), planted.end(),
            recording.torque_Nm[j].begin() + static_cast<std::ptrdiff_t>(first));
}

diagnose::Diagnosis decide(const Recording& recording, const model::ModelDescription& model,
                           bool by_evidence) {
  return by_evidence ? diagnose::evidence::decide(std::span(&recording, 1), model, {})
                     : diagnose::diagnose(std::span(&recording, 1), {}, model, {});
}

std::vector<Half> halvesOf(const std::vector<MeasuredRecording>& all, bool by_evidence) {
  std::vector<Half> halves;
  for (const MeasuredRecording& source : all) {
    const Segment whole = part(source.recording, 0.0, 1.0).segments.front();
    if (static_cast<double>(whole.end - whole.first) < 4.0 * kShortest_s * source.recording.rate_Hz) {
      continue;
    }
    for (const bool second : {false, true}) {
      const Recording other = part(source.recording, second ? 0.0 : 0.5, second ? 0.5 : 1.0);
      halves.push_back({.source = &source,
                        .from = second ? 0.5 : 0.0,
                        .to = second ? 1.0 : 0.5,
                        .model = decide(other, source.model, by_evidence).extended});
      std::fprintf(stderr, "model of %s, half %d: %zu effects\n", source.name.c_str(), second ? 1 : 2,
                   halves.back().model.effects.size());
    }
  }
  return halves;
}

struct Counts {
  std::size_t plain = 0, plain_false = 0, planted = 0, right = 0, in_set = 0, false_effect = 0, unknown = 0,
              nothing = 0;
};

bool names(const diagnose::EffectFinding& finding, const Plant& plant, bool& alone) {
  if (finding.joint != plant.joint) {
    return false;
  }
  alone = finding.kind == plant.kind;
  return alone || std::find(finding.indistinguishable_from.begin(), finding.indistinguishable_from.end(),
                            plant.kind) != finding.indistinguishable_from.end();
}

void mark(const diagnose::Diagnosis& diagnosis, const std::optional<Plant>& plant, Counts& counts) {
  if (!plant) {
    ++counts.plain;
    counts.plain_false += diagnosis.effects.empty() ? 0 : 1;
    return;
  }
  ++counts.planted;
  bool found = false, alone = false, other = false;
  for (const diagnose::EffectFinding& finding : diagnosis.effects) {
    bool exactly = false;
    const bool is = names(finding, *plant, exactly);
    found = found || is;
    alone = alone || exactly;
    other = other || !is;
  }
  counts.right += found && alone && !other ? 1 : 0;
  counts.in_set += found && !alone && !other ? 1 : 0;
  counts.false_effect += other ? 1 : 0;
  counts.unknown += !found && !other && diagnosis.verdict == diagnose::Verdict::kUnknownEffect ? 1 : 0;
  counts.nothing += diagnosis.verdict == diagnose::Verdict::kNothingMissing ? 1 : 0;
}

std::string line(const std::string& name, const Counts& c) {
  return fmt::format("  {:<34}{:>7}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n", name, c.plain, c.plain_false,
                     c.planted, c.right, c.in_set, c.false_effect, c.unknown, c.nothing);
}

}  // namespace

std::string runPlanted(const PlantedOptions& options) {
  const std::vector<MeasuredRecording> all = measuredRecordings(options.data, options.source);
  const std::vector<Half> halves = halvesOf(all, options.by_evidence);
  std::ofstream table;
  if (!options.out.empty()) {
    std::filesystem::create_directories(options.out);
    table.open(options.out / "planted.csv");
    table << "case,rig,recording,planted,share,verdict,found\n";
  }
  Counts sum;
  std::map<std::string, Counts> by_rig, by_kind;
  for (std::size_t i = 0; i < options.cases; ++i) {
    Random random(options.seed, i);
    const Half& half = halves[random.below(halves.size())];
    const double length = (half.to - half.from) * random.uniform(0.75, 1.0);
    const double from = half.from + random.uniform(0.0, half.to - half.from - length);
    Recording recording = part(half.source->recording, from, from + length);
    const model::DynamicsModel bare = model::makeModel({.mechanism = half.model.mechanism, .effects = {}});
    std::optional<Plant> plant;
    if (!random.chance(options.plain_share)) {
      const auto joint = static_cast<int>(random.below(static_cast<std::size_t>(recording.joints)));
      const diagnose::Dataset data(std::span(&recording, 1), {});
      plant = drawPlant(sizeOf(data, bare, joint), joint, random);
      plantIn(recording, *plant, bare.mechanism());
    }
    diagnose::Diagnosis diagnosis = decide(recording, half.model, options.by_evidence);
    keepAsserted(diagnosis);
    for (Counts* counts : {&sum, &by_rig[half.source->rig], &by_kind[plant ? plant->kind : "nothing"]}) {
      mark(diagnosis, plant, *counts);
    }
    std::string found;
    for (const diagnose::EffectFinding& effect : diagnosis.effects) {
      found += fmt::format("{}@{}{{{}}} ", effect.kind, effect.joint + 1,
                           fmt::join(effect.indistinguishable_from, " "));
    }
    const std::string row =
        fmt::format("{},{},{},{},{:.3f},{},{}", i, half.source->rig, half.source->name,
                    plant ? fmt::format("{}@{}", plant->kind, plant->joint + 1) : "",
                    plant ? plant->share : 0.0, diagnose::verdictName(diagnosis.verdict), found);
    std::fprintf(stderr, "%s\n", row.c_str());
    if (table.is_open()) {
      table << row << "\n" << std::flush;
    }
  }
  std::string text = fmt::format("  {:<34}{:>7}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}{:>9}\n", "", "plain", "false",
                                 "planted", "right", "in a set", "false", "unknown", "nothing");
  for (const auto& [rig, counts] : by_rig) {
    text += line(rig, counts);
  }
  for (const auto& [kind, counts] : by_kind) {
    text += line(kind, counts);
  }
  return text + line("all", sum);
}

}  // namespace patella::bench
