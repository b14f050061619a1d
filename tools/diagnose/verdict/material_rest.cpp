#include "tools/diagnose/verdict/material_rest.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// The joint, of those chosen, that keeps the largest share of its torque; nothing where none is chosen.
template <typename Chosen>
std::optional<std::size_t> worstOf(std::span<const JointRest> rests, Chosen chosen) {
  std::optional<std::size_t> worst;
  for (std::size_t j = 0; j < rests.size(); ++j) {
    if (chosen(j) && (!worst || rests[*worst].structure_Nm() * rests[j].torque_Nm <
                                    rests[j].structure_Nm() * rests[*worst].torque_Nm)) {
      worst = j;
    }
  }
  return worst;
}

std::string wordsOf(const JointRest& rest, std::size_t joint, bool person, std::string_view unit) {
  return fmt::format(
      "No effect of the library explains what is left: {:.3g} {} on joint {}, {:.0f} % of its torque, where "
      "sensors{} make {:.2g} {}. Pushes of a person are to be declared (--person).",
      rest.structure_Nm(), unit, joint + 1, kPercent * rest.structure_Nm() / rest.torque_Nm,
      person ? " and declared pushes" : "", rest.noise_Nm, unit);
}

// Of a joint that is not driven, beside some that are.
std::string deadWords(const JointRest& rest, std::size_t joint, std::string_view unit) {
  return fmt::format(
      "The torque of joint {} is next to nothing, where the model's parts ask for {:.3g} {}. "
      "{:.0f} % of that is left: its column may be dead.",
      joint + 1, rest.torque_Nm, unit, kPercent * rest.structure_Nm() / rest.torque_Nm);
}

}  // namespace

void judgeRest(std::span<const JointRest> rests, std::span<const double> before_Nm, bool person,
               Diagnosis& diagnosis) {
  for (const JointRest& rest : rests) {
    diagnosis.rests.push_back(
        {.torque_Nm = rest.torque_Nm, .structure_Nm = rest.structure_Nm(), .noise_Nm = rest.noise_Nm});
  }
  const bool any_driven =
      std::any_of(rests.begin(), rests.end(), [](const JointRest& rest) { return rest.driven; });
  const auto mayBeDead = [&](std::size_t joint) { return any_driven && !rests[joint].driven; };
  const auto doubt = [&](Doubt::Kind kind, std::size_t joint) {
    const std::string unit = unitsOf(diagnosis, static_cast<int>(joint)).torque;
    diagnosis.doubts.push_back({kind, mayBeDead(joint) ? deadWords(rests[joint], joint, unit)
                                                       : wordsOf(rests[joint], joint, person, unit)});
  };
  const auto hasFinding = [&](std::size_t joint) {
    return std::any_of(diagnosis.effects.begin(), diagnosis.effects.end(), [joint](const auto& effect) {
      return effect.asserted() && effect.joint == static_cast<int>(joint);
    });
  };
  std::vector<double> found_share(rests.size());  // what was found explains so much of a joint's torque
  for (std::size_t joint = 0; joint < rests.size(); ++joint) {
    if (hasFinding(joint) && before_Nm[joint] > rests[joint].left_Nm) {
      found_share[joint] = std::sqrt(std::pow(before_Nm[joint], 2) - std::pow(rests[joint].left_Nm, 2)) /
                           rests[joint].torque_Nm;
    }
  }
  const double most_found = found_share.empty() ? 0.0 : std::ranges::max(found_share);
  // A spring may stand for a column that is dead. And a trifle that was found is not the answer where more is
  // missing, on another joint or beside it.
  const auto isUnexplained = [&](std::size_t joint) {
    if (hasFinding(joint) && !mayBeDead(joint)) {
      return rests[joint].exceeds(
          std::max(unknown::kRestOfNothing, unknown::kShareOfFound * found_share[joint]));
    }
    return rests[joint].exceeds(unknown::kMaterialRest) ||
           (most_found > 0.0 &&
            rests[joint].exceeds(std::max(unknown::kRestOfNothing, unknown::kShareOfFound * most_found)));
  };
  if (const auto unexplained = worstOf(rests, isUnexplained)) {
    doubt(Doubt::kJointUnexplained, *unexplained);
  }
  const auto worst = worstOf(rests, [](std::size_t) { return true; });
  if (worst && rests[*worst].exceeds(unknown::kRestOfNothing)) {
    doubt(rests[*worst].exceeds(unknown::kMaterialRest) ? Doubt::kLargeRest : Doubt::kSomeRest, *worst);
  }
}

}  // namespace patella::diagnose
