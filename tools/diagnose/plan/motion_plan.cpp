#include "tools/diagnose/plan/motion_plan.hpp"

#include <algorithm>
#include <tuple>
#include <utility>

#include "tools/diagnose/effects/considered.hpp"

namespace patella::diagnose {
namespace {

bool asksFor(const std::vector<std::string>& effects, std::string_view word) {
  return std::find(effects.begin(), effects.end(), word) != effects.end();
}

std::vector<PlannedEffect> effectsOf(const PlanRequest& request, const MotionLimits& limits) {
  if (asksFor(request.effects, "none")) {
    return {};
  }
  return plannedEffects(request.effects, request.model, limits, request.timing.duration_s);
}

InformationOptions informationOptions(const PlanRequest& request, bool parameters) {
  return {.noise = request.noise, .nominal_tolerance = request.nominal_tolerance, .parameters = parameters};
}

}  // namespace

MotionPlan makePlan(const PlanRequest& request) {
  const int joints = request.model.joints();
  const MotionLimits limits = usableLimits(request.limits, joints);
  MotionPlan plan;
  plan.parameters = asksFor(request.effects, "all") || asksFor(request.effects, "none");
  const std::vector<PlannedEffect> effects = effectsOf(request, limits);
  Information information(request.model, effects, informationOptions(request, plan.parameters));
  MotionFamily family(request.timing, harmonicsOf(request.timing, joints), limits, request.reach,
                      request.start_rad, request.model);
  TorqueAlong torque(request.model);
  plan.motion = designMotion(family, information, request.start_rad, limits, request.reach, torque,
                             request.timing.duration_s, request.design);
  plan.revealed = information.revealed(plan.motion.sampled);
  std::sort(plan.revealed.begin(), plan.revealed.end(), [](const Revealed& a, const Revealed& b) {
    return std::tie(b.share_of_torque, a.kind, a.joint) < std::tie(a.share_of_torque, b.kind, b.joint);
  });
  for (const Revealed& revealed : plan.revealed) {
    if (request.bounding) {
      request.bounding(static_cast<double>(plan.headroom.size()) / static_cast<double>(effects.size()));
    }
    const auto effect = std::find_if(effects.begin(), effects.end(), [&](const PlannedEffect& one) {
      return one.recipe->kind == revealed.kind && one.recipe->joint == revealed.joint;
    });
    plan.headroom.push_back(Information(request.model, {*effect}, informationOptions(request, false))
                                .headroom(plan.motion.sampled, limits));
  }
  PlanRequest common = request;
  common.effects = commonKinds();
  plan.others = revealedBy(common, plan.motion.sampled);
  std::erase_if(plan.others, [&](const Revealed& other) {
    return std::any_of(plan.revealed.begin(), plan.revealed.end(), [&](const Revealed& asked) {
      return asked.kind == other.kind && asked.joint == other.joint;
    });
  });
  return plan;
}

std::vector<Revealed> revealedBy(const PlanRequest& request, const SampledMotion& motion) {
  const MotionLimits limits = usableLimits(request.limits, request.model.joints());
  Information information(request.model, effectsOf(request, limits), informationOptions(request, false));
  return information.revealed(motion);
}

}  // namespace patella::diagnose
