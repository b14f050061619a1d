#include "tools/bench/diagnose/cases.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "tools/bench/diagnose/constants.hpp"
#include "tools/bench/diagnose/draw_effect.hpp"
#include "tools/bench/diagnose/nominal_directions.hpp"
#include "tools/bench/diagnose/random.hpp"

namespace patella::bench {
namespace {

TrueEffect scaled(TrueEffect effect, double factor) {
  for (std::size_t i = 0; i < kMaxParameters; ++i) {
    effect.p[i] *= (effect.info().scaled >> i & 1U) != 0 ? factor : 1.0;
  }
  return effect;
}

// Where the scaled parameter that leads them all stands.
double sizeOf(const TrueEffect& effect) {
  for (std::size_t i = 0; i < kMaxParameters; ++i) {
    if ((effect.info().scaled >> i & 1U) != 0 && effect.p[i] != 0.0) {
      return std::abs(effect.p[i]);
    }
  }
  return 1.0;
}

bool isDryFriction(Kind kind) {
  constexpr std::array kDry{Kind::kCoulomb, Kind::kAsymmetric, Kind::kStribeck, Kind::kLoadDependent,
                            Kind::kPresliding};
  return std::find(kDry.begin(), kDry.end(), kind) != kDry.end();
}

bool changesDrive(Kind kind) {
  constexpr std::array kDrive{Kind::kElasticity, Kind::kBacklash, Kind::kLag, Kind::kDelay};
  return std::find(kDrive.begin(), kDrive.end(), kind) != kDrive.end();
}

// Whether two effects on one joint are so near to each other that naming both is not to be asked.
bool entangled(const TrueEffect& a, const TrueEffect& b) {
  if (a.joint != b.joint) {
    return false;
  }
  const auto either = [&](Kind one, Kind other) {
    return (a.kind == one && b.kind == other) || (a.kind == other && b.kind == one);
  };
  return a.kind == b.kind || (isDryFriction(a.kind) && isDryFriction(b.kind)) ||
         (changesDrive(a.kind) && changesDrive(b.kind)) || either(Kind::kAsymmetric, Kind::kBias) ||
         either(Kind::kAsymmetric, Kind::kViscous) || either(Kind::kStiffness, Kind::kPassiveKnee) ||
         either(Kind::kStiffness, Kind::kBias) || either(Kind::kBias, Kind::kPassiveKnee) ||
         either(Kind::kElasticity, Kind::kRotor) || either(Kind::kThermal, Kind::kBias);
}

struct Place {
  Kind kind;
  std::size_t joint;
};

std::vector<Place> places(const Rig& rig, Suite suite, const std::string& wanted) {
  const bool defect = suite == Suite::kDefect;
  const bool in_library = !defect && suite != Suite::kUnknown;
  std::vector<Place> result;
  for (const KindInfo& info : allKinds()) {
    for (std::size_t j = 0; j < rig.body.joints(); ++j) {
      if (info.in_library == in_library && info.defect == defect && (wanted.empty() || info.name == wanted) &&
          applicable(info.kind, j, rig)) {
        result.push_back({info.kind, j});
      }
    }
  }
  return result;
}

// Every kind is as likely as another, whatever the number of joints it could be on.
Place pick(Random& random, const std::vector<Place>& from) {
  std::vector<Kind> kinds;
  for (const Place& place : from) {
    if (kinds.empty() || kinds.back() != place.kind) {
      kinds.push_back(place.kind);
    }
  }
  const Kind kind = kinds[random.below(kinds.size())];
  std::vector<Place> joints;
  std::copy_if(from.begin(), from.end(), std::back_inserter(joints),
               [kind](const Place& place) { return place.kind == kind; });
  return joints[random.below(joints.size())];
}

// A model that lacks viscous friction may have none on this joint, or too little; what it has is right.
void agreeOnDamping(Random& random, const TrueEffect& effect, Rig& rig) {
  const bool viscous = effect.kind == Kind::kViscous ||
                       (effect.kind == Kind::kAsymmetric && effect.p[2] > 0.0) ||
                       (effect.kind == Kind::kThermal && effect.p[2] > 0.0);
  if (viscous) {
    const std::size_t j = effect.joint;
    if (random.chance(0.5)) {
      rig.body.damping_Nms_rad[j] = 0.0;
    }
    rig.nominal.damping_Nms_rad[j] = rig.body.damping_Nms_rad[j];
  }
}

/// Share of the declared damping: two standard deviations of what a diagnosis takes it to be known to.
constexpr double kDeclaredDoubt = 0.2;

bool isWithinDeclaredDamping(const Rig& rig, const TrueEffect& effect) {
  return effect.kind == Kind::kViscous &&
         effect.p[0] < kDeclaredDoubt * rig.nominal.damping_Nms_rad[effect.joint];
}

CaseEffect measured(const Rig& rig, const TrueEffect& effect, const Run& run) {
  const Analysis analysis = analyse(rig, run);
  return {.effect = effect,
          .strength = analysis.strength,
          .raw_strength = analysis.raw_strength,
          .in_span = inSpan(effect, rig.body) || isWithinDeclaredDamping(rig, effect)};
}

std::vector<TrueEffect> effectsOf(const Case& drawn) {
  std::vector<TrueEffect> effects;
  for (const CaseEffect& effect : drawn.effects) {
    effects.push_back(effect.effect);
  }
  return effects;
}

// Two effects that a rig bears one by one may be too much together. False where even a little of them is. One
// effect alone has run already.
bool simulateCase(Case& drawn) {
  constexpr int kTries = 6;
  for (int attempt = 0; attempt < kTries; ++attempt) {
    if (attempt > 0 || drawn.effects.size() != 1) {
      drawn.run = simulate(drawn.rig, effectsOf(drawn));
    }
    if (drawn.run.stable) {
      return true;
    }
    for (CaseEffect& effect : drawn.effects) {
      effect.effect = scaled(effect.effect, 0.5);
      effect.strength *= 0.5;
      effect.raw_strength *= 0.5;
    }
  }
  return false;
}

// Attempts of one case differ in everything that is drawn.
constexpr std::uint64_t kAttempts = 300;
std::uint64_t seedOf(const Case& drawn, std::uint64_t attempt) {
  return drawn.seed + (attempt << 40U);
}

void drawRigOf(Case& drawn, const Wish& wish, std::uint64_t seed) {
  drawn.mechanism = wish.mechanism;
  drawn.motion = wish.motion;
  drawn.rig = drawRig(seed, drawn.mechanism, drawn.motion, wish.joints);
}

// Draws a rig and its effects, and runs it with the last one. False where the way does not show an effect:
// play in a gear that gravity keeps on one side, a spring that is no more than the rotor behind it.
bool tryEffects(Case& drawn, const Wish& wish, std::uint64_t seed) {
  drawn.effects.clear();
  drawRigOf(drawn, wish, seed);
  Random random(seed, 200);
  const bool two = drawn.suite == Suite::kDouble;
  while (drawn.effects.size() < (two ? 2U : 1U)) {
    const bool first = drawn.effects.empty();
    const std::vector<Place> choice = places(drawn.rig, drawn.suite, first ? wish.effect : std::string());
    if (choice.empty()) {
      return false;
    }
    const Place place = pick(random, choice);
    const TrueEffect effect = drawEffect(random, place.kind, place.joint, drawn.rig);
    const bool in_span = inSpan(effect, drawn.rig.body);
    // Two effects are asked for by name only where each of them can be told from the nominal parameters.
    if (!first && (in_span || entangled(drawn.effects.front().effect, effect))) {
      continue;
    }
    if (two && in_span) {
      return false;
    }
    agreeOnDamping(random, effect, drawn.rig);
    if (in_span) {
      drawn.run = simulate(drawn.rig, std::span(&effect, 1));
      drawn.effects.push_back(measured(drawn.rig, effect, drawn.run));
      continue;
    }
    constexpr double kWeakest = 0.5, kWeakestOfTwo = 1.0, kStrongest = 5.0;
    const double weakest = two ? kWeakestOfTwo : kWeakest;
    const double strength = wish.strength > 0.0 ? wish.strength : random.logUniform(weakest, kStrongest);
    ScaledEffect shown = withStrength(drawn.rig, effect, strength);
    drawn.effects.push_back(shown.effect);
    drawn.run = std::move(shown.run);
    if (drawn.effects.back().strength < 0.9 * std::min(strength, weakest)) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::string_view suiteName(Suite suite) noexcept {
  constexpr std::array<std::string_view, 5> kNames{"none", "single", "double", "unknown", "defect"};
  return kNames[static_cast<std::size_t>(suite)];
}

ScaledEffect withStrength(const Rig& rig, const TrueEffect& effect, double strength) {
  const Pair range = sizeLimits(rig, effect);
  const auto within = [&](const TrueEffect& wanted) {
    const double size = sizeOf(wanted);
    return scaled(wanted, std::clamp(size, range[0], range[1]) / size);
  };
  constexpr int kTries = 7;
  constexpr double kNear = 0.01;
  TrueEffect now = within(effect);
  ScaledEffect best{.effect = {.effect = now}, .run = {}};
  double best_miss = kUnlimited;
  std::optional<Pair> last;  // logarithms of size and strength
  for (int attempt = 0; attempt < kTries; ++attempt) {
    Run run = simulate(rig, std::span(&now, 1));
    if (!run.stable) {
      now = scaled(now, 0.4);
      last.reset();
      continue;
    }
    const CaseEffect result = measured(rig, now, run);
    const double miss = std::abs(std::log(result.strength / strength));
    if (miss < best_miss) {
      best_miss = miss;
      best = {.effect = result, .run = std::move(run)};
    }
    if (miss < kNear) {
      break;
    }
    const Pair point{std::log(sizeOf(now)), std::log(result.strength)};
    double slope = 1.0;
    if (last && std::abs(point[0] - (*last)[0]) > 1e-6) {
      slope = std::clamp((point[1] - (*last)[1]) / (point[0] - (*last)[0]), 0.3, 3.0);
    }
    last = point;
    const TrueEffect next =
        within(scaled(now, std::clamp(std::exp((std::log(strength) - point[1]) / slope), 0.05, 20.0)));
    if (std::abs(std::log(sizeOf(next) / sizeOf(now))) < 1e-6) {
      break;  // at a limit
    }
    now = next;
  }
  return best;
}

Case drawCase(std::uint64_t seed, Suite suite, const Wish& wish) {
  Case drawn;
  drawn.seed = seed;
  drawn.suite = suite;
  bool runs_away = false;
  for (std::uint64_t attempt = 0; attempt < kAttempts; ++attempt) {
    if (suite == Suite::kNone) {
      drawRigOf(drawn, wish, seedOf(drawn, attempt));
    } else if (!tryEffects(drawn, wish, seedOf(drawn, attempt))) {
      continue;
    }
    if (simulateCase(drawn)) {
      drawn.run.recording.name = std::string(suiteName(suite)) + "-" + std::to_string(seed);
      drawn.nominal = nominalModel(drawn.rig);
      return drawn;
    }
    runs_away = true;
  }
  if (runs_away) {
    throw std::runtime_error("case " + std::to_string(seed) + ": the robot runs away");
  }
  throw std::invalid_argument("effect '" + wish.effect + "' is unknown to suite " +
                              std::string(suiteName(suite)) + ", or shows on no joint of " +
                              (wish.mechanism.empty() ? "any machine" : wish.mechanism));
}

}  // namespace patella::bench
