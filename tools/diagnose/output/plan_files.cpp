#include "tools/diagnose/output/plan_files.hpp"

#include <algorithm>
#include <cmath>
#include <ostream>
#include <span>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/wording.hpp"
#include "tools/diagnose/output/revealed_json.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/power.hpp"

namespace patella::diagnose {
namespace {

using Json = nlohmann::ordered_json;

/// Digits of what was rounded to five decimals, frequencies to four.
constexpr int kDecimals = 5;

const control::MultisineMotion& wavesOf(const MotionPlan& plan, int joint) {
  return std::get<control::MultisineMotion>(plan.motion.reference.motion[static_cast<std::size_t>(joint)]);
}

std::string decimals(double value) {
  std::string text = fmt::format("{:.{}f}", value, kDecimals);
  text.erase(text.find_last_not_of('0') + 1);
  return text.ends_with('.') ? text + "0" : text;
}

template <typename Get>
std::string listed(const control::MultisineMotion& waves, Get&& get) {
  std::vector<std::string> numbers;
  for (const control::SineComponent& component : waves.components) {
    numbers.push_back(decimals(get(component)));
  }
  return fmt::format("[{}]", fmt::join(numbers, ", "));
}

std::string askedFor(const MotionPlan& plan, const PlanRequest& request) {
  std::string text = plan.parameters ? "all base parameters" : "";
  if (plan.revealed.empty()) {
    return text;
  }
  return text + (text.empty() ? "" : " and ") +
         (plan.parameters ? "every effect of the library"
                          : fmt::format("{}", fmt::join(request.effects, ", ")));
}

Json describedAll(const std::vector<Revealed>& all) {
  Json out = Json::array();
  for (const Revealed& revealed : all) {
    out.push_back(describeRevealed(revealed));
  }
  return out;
}

// `headroom` of the first of them; the others have none.
void printSizes(const std::vector<Revealed>& all, std::span<const double> headroom,
                const model::MechanismDescription& mechanism, std::ostream& out) {
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Revealed& revealed = all[i];
    const bool shows = std::isfinite(revealed.share_of_torque);
    const bool known = shows && i < headroom.size() && std::isfinite(headroom[i]);
    out << fmt::format("  {:<28}{:>6}  {:<26}{:>10}{}\n", effectWords(revealed.kind), revealed.joint + 1,
                       sizeWords(revealed, unitsOf(mechanism, revealed.joint)),
                       shows ? shortNumber(kPercent * revealed.share_of_torque) + " %" : "–",
                       known ? fmt::format("{:>8.2f}", headroom[i]) : "");
  }
}

}  // namespace

std::string planReference(const MotionPlan& plan, const PlanRequest& request, const PlanOrigin& origin) {
  const int joints = request.model.joints();
  std::string text = fmt::format(
      "# A motion that patella-diagnose {} planned so that a recording of it tells\n#   {}\n"
      "# Run it by patella run --reference for {} s from activation on, from the pose ({}) rad.\n"
      "# It takes {:.0f} % of the range, {:.0f} % of the speed and {:.0f} % of the torque that a plan may "
      "take\n"
      "# of the limits {}: {:.0f} % of the torque, {:.0f} % of the speed, and the range less its margins.\n",
      PATELLA_VERSION, askedFor(plan, request), app::formatNumber(request.timing.duration_s),
      [&] {
        std::vector<std::string> start;
        for (int j = 0; j < joints; ++j) {
          start.push_back(decimals(request.start_rad[j]));
        }
        return fmt::format("{}", fmt::join(start, ", "));
      }(),
      kPercent * plan.motion.use.position, kPercent * plan.motion.use.speed,
      kPercent * plan.motion.use.torque, origin.limits, kPercent * kTorqueShare, kPercent * kSpeedShare);
  for (const InputFile& input : origin.inputs) {
    text += fmt::format("#   {} (SHA-256 {})\n", input.path, input.sha256);
  }
  text += fmt::format("# Seed {}.\nblend_s = {}\n", request.design.seed,
                      app::formatNumber(plan.motion.reference.blend_s));
  for (int j = 0; j < joints; ++j) {
    const control::MultisineMotion& waves = wavesOf(plan, j);
    text += fmt::format(
        "\n[[joint]]\nmotion = \"multisine\"\noffset_rad = {}\nfrequency_Hz = {}\namplitude_rad = "
        "{}\nphase_rad = {}\n",
        decimals(waves.offset_rad), listed(waves, [](const auto& wave) { return wave.frequency_Hz; }),
        listed(waves, [](const auto& wave) { return wave.amplitude_rad; }),
        listed(waves, [](const auto& wave) { return wave.phase_rad; }));
  }
  return text;
}

std::string planJson(const MotionPlan& plan, const PlanRequest& request, const PlanOrigin& origin) {
  Json out;
  out["asked_for"] = {{"parameters", plan.parameters}, {"effects", request.effects}};
  out["criterion"] = {{"log_determinant", plan.motion.log_determinant},
                      {"of_first_motion", plan.motion.first_log_determinant},
                      {"evaluations", request.design.evaluations},
                      {"seed", request.design.seed}};
  out["duration_s"] = request.timing.duration_s;
  out["blend_s"] = plan.motion.reference.blend_s;
  out["joints"] = Json::array();
  for (int j = 0; j < request.model.joints(); ++j) {
    const auto index = static_cast<std::size_t>(j);
    const safety::JointLimits& limit = request.limits.joint[index];
    const control::MultisineMotion& waves = wavesOf(plan, j);
    Json motion = {{"offset_rad", waves.offset_rad},
                   {"frequency_Hz", Json::array()},
                   {"amplitude_rad", Json::array()},
                   {"phase_rad", Json::array()}};
    for (const control::SineComponent& wave : waves.components) {
      motion["frequency_Hz"].push_back(wave.frequency_Hz);
      motion["amplitude_rad"].push_back(wave.amplitude_rad);
      motion["phase_rad"].push_back(wave.phase_rad);
    }
    out["joints"].push_back({{"start_rad", request.start_rad[j]},
                             {"motion", motion},
                             {"limits",
                              {{"q_min_rad", limit.q_min_rad},
                               {"q_max_rad", limit.q_max_rad},
                               {"velocity_rad_s", limit.velocity_rad_s},
                               {"torque_Nm", limit.torque_Nm}}},
                             {"noise_Nm", request.noise[index].noise_Nm},
                             {"beyond_noise_Nm", request.noise[index].structure_Nm}});
  }
  out["use_of_limits"] = {{"position", plan.motion.use.position},
                          {"speed", plan.motion.use.speed},
                          {"torque", plan.motion.use.torque},
                          {"reach", plan.motion.use.reach}};
  out["revealed"] = describedAll(plan.revealed);
  for (std::size_t i = 0; i < plan.revealed.size(); ++i) {
    // A number that is none becomes null.
    out["revealed"][i]["any_motion_smaller_by_at_most"] = plan.headroom[i];
  }
  out["also_revealed"] = describedAll(plan.others);
  out["inputs"] = Json::array();
  for (const InputFile& input : origin.inputs) {
    out["inputs"].push_back({{"path", input.path}, {"sha256", input.sha256}});
  }
  out["versions"] = {{"patella", PATELLA_VERSION}};
  return out.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

PlanWords planWords(const MotionPlan& plan, const PlanRequest& request) {
  std::vector<std::string> noise;
  for (std::size_t j = 0; j < request.noise.size(); ++j) {
    noise.push_back(fmt::format("{:.2g} {}",
                                std::hypot(request.noise[j].noise_Nm, request.noise[j].structure_Nm),
                                unitsOf(request.model.mechanism, static_cast<int>(j)).torque));
  }
  const LimitUse& use = plan.motion.use;
  return {.motion = fmt::format("A motion of {} s for {}.", app::formatNumber(request.timing.duration_s),
                                askedFor(plan, request)),
          .use = fmt::format("{:.0f} % of the range, {:.0f} % of the speed and {:.0f} % of the torque",
                             kPercent * use.position, kPercent * use.speed, kPercent * use.torque),
          .noise = fmt::format("{}", fmt::join(noise, " and "))};
}

void printPlan(const MotionPlan& plan, const PlanRequest& request, const std::filesystem::path& folder,
               std::ostream& out) {
  const PlanWords words = planWords(plan, request);
  out << words.motion << "\n  it takes " << words.use
      << " that a plan may take\n  four in five recordings of it would reveal, against noise of "
      << words.noise << ":\n";
  const bool bounded = std::any_of(plan.headroom.begin(), plan.headroom.end(),
                                   [](double headroom) { return std::isfinite(headroom); });
  out << fmt::format("  {:<28}{:>6}  {:<26}{:>10}{}\n", "effect", "joint", "from", "of torque",
                     bounded ? "   limit" : "");
  printSizes(plan.revealed, plan.headroom, request.model.mechanism, out);
  if (!plan.others.empty()) {
    out << (plan.revealed.empty() ? "" : "  and, without having been asked for:\n");
    printSizes(plan.others, {}, request.model.mechanism, out);
  }
  out << fmt::format("  a torque of less than {} % of the load is nothing that anybody would miss\n",
                     shortNumber(kPercent * accepted::kLeastOfLoad));
  if (bounded) {
    out << "  limit: no motion of this duration, within these limits, shows sizes smaller by more than this "
           "factor\n";
  }
  out << "  files in " << folder.string() << ": reference.toml, plan.json, plan.html\n";
}

}  // namespace patella::diagnose
