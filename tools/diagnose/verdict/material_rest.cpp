#include "tools/diagnose/verdict/material_rest.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {

void judgeRest(std::span<const JointRest> rests, bool person, Diagnosis& diagnosis) {
  for (const JointRest& rest : rests) {
    diagnosis.rests.push_back(
        {.torque_Nm = rest.torque_Nm, .structure_Nm = rest.structure_Nm(), .noise_Nm = rest.noise_Nm});
  }
  const auto worst = std::max_element(rests.begin(), rests.end(), [](const auto& a, const auto& b) {
    return a.structure_Nm() * b.torque_Nm < b.structure_Nm() * a.torque_Nm;
  });
  if (!worst->exceeds(unknown::kRestOfNothing)) {
    return;
  }
  diagnosis.doubts.push_back(
      {worst->exceeds(unknown::kMaterialRest) ? Doubt::kLargeRest : Doubt::kSomeRest,
       fmt::format(
           "No effect of the library explains what is left: {:.3g} {} on joint {}, {:.0f} % of its torque, "
           "where sensors{} make {:.2g} {}. Pushes of a person are to be declared (--person).",
           worst->structure_Nm(), diagnosis.torque_unit, worst - rests.begin() + 1,
           kPercent * worst->structure_Nm() / worst->torque_Nm, person ? " and declared pushes" : "",
           worst->noise_Nm, diagnosis.torque_unit)});
}

}  // namespace patella::diagnose
