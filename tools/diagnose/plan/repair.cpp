#include "tools/diagnose/plan/repair.hpp"

#include <algorithm>
#include <cstddef>
#include <iterator>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/file_error.hpp"
#include "tools/diagnose/effects/considered.hpp"

namespace patella::diagnose {
namespace {

// As a shell takes it.
std::string quoted(const std::string& text) {
  const bool plain = !text.empty() && text.find_first_not_of(
                                          "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ"
                                          "0123456789_-./,@=+:") == std::string::npos;
  if (plain) {
    return text;
  }
  std::string result = "'";
  for (const char letter : text) {
    result += letter == '\'' ? "'\\''" : std::string(1, letter);
  }
  return result + "'";
}

std::string kindOf(const std::string& label) {
  return label.substr(0, label.find('@'));
}

bool isCommonLabel(const std::string& label) {
  const std::vector<std::string> common = commonKinds();
  return std::find(common.begin(), common.end(), kindOf(label)) != common.end();
}

// "coulomb_friction@2", but no nominal parameter, and nothing that no motion could show.
bool canBeShown(const std::string& label) {
  return label.find('@') != std::string::npos && model::findEffect(kindOf(label)) != nullptr &&
         isPlannable(kindOf(label));
}

bool isPayload(const std::string& label) {
  return kindOf(label) == "payload";
}

nlohmann::json loadDiagnosis(const std::filesystem::path& path) {
  const std::string text = app::readFile(path, files::kResultFile);
  std::string where;
  try {
    return nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const auto end = text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size()));
    where = fmt::format(": line {}", 1 + std::count(text.begin(), end, '\n'));
  } catch (const nlohmann::json::exception&) {
    // A number beyond all bounds, of which it does not say where it stands.
  }
  throw app::FileError(path.string() + ": is no JSON" + where +
                       ", expected the diagnosis.json of patella-diagnose");
}

}  // namespace

std::vector<std::string> effectsToShow(const std::vector<std::string>& found,
                                       const std::vector<std::string>& not_identifiable, int joints) {
  std::vector<std::string> effects;
  const auto add = [&](const std::string& label) {
    if (std::find(effects.begin(), effects.end(), label) == effects.end()) {
      effects.push_back(label);
    }
  };
  const auto addCommon = [&](int joint) {
    for (const std::string& kind : commonKinds()) {
      if (!isPayload(kind)) {
        add(fmt::format("{}@{}", kind, joint + 1));
      }
    }
  };
  std::vector<std::string> untold;
  std::copy_if(not_identifiable.begin(), not_identifiable.end(), std::back_inserter(untold),
               [](const std::string& label) { return canBeShown(label) && !isPayload(label); });
  const bool any_common = std::any_of(untold.begin(), untold.end(), isCommonLabel);
  std::for_each(found.begin(), found.end(), [&](const std::string& label) {
    if (canBeShown(label)) {
      add(label);
    }
  });
  const bool any_found = !effects.empty();
  for (const std::string& label : untold) {
    if (isCommonLabel(label) || (!any_common && !any_found)) {
      add(label);
    }
  }
  for (int joint = 0; joint < joints; ++joint) {
    const std::string resting = fmt::format("joint {} is at rest", joint + 1);
    if (std::find(not_identifiable.begin(), not_identifiable.end(), resting) != not_identifiable.end()) {
      addCommon(joint);
    }
  }
  if (effects.empty()) {
    for (int joint = 0; joint < joints; ++joint) {
      addCommon(joint);
    }
  }
  return effects;
}

std::string planCommandLine(const Diagnosis& diagnosis, const std::filesystem::path& model,
                            const std::filesystem::path& out) {
  if (diagnosis.verdict != Verdict::kInsufficientExcitation) {
    return {};
  }
  const auto joints = static_cast<int>(diagnosis.excitation.position_range_rad.size());
  std::vector<std::string> found;
  for (const EffectFinding& effect : diagnosis.effects) {
    found.push_back(fmt::format("{}@{}", effect.kind, effect.joint + 1));
  }
  return fmt::format("patella-diagnose --plan --config CONFIG --model {} --from {} --effects {} --out {}",
                     quoted(model.string()), quoted((out / "diagnosis.json").string()),
                     fmt::join(effectsToShow(found, diagnosis.excitation.not_identifiable, joints), ","),
                     quoted((out / "plan").string()));
}

std::string runCommandLine(const std::filesystem::path& config, const std::filesystem::path& plan) {
  return fmt::format("patella run --config {} --reference {}",
                     config.empty() ? "CONFIG" : quoted(config.string()),
                     quoted((plan / "reference.toml").string()));
}

Unrevealed readUnrevealed(const std::filesystem::path& diagnosis_json, int joints) {
  const nlohmann::json json = loadDiagnosis(diagnosis_json);
  const auto expected = [&](const char* what) {
    return app::FileError(diagnosis_json.string() + ": " + what + ", as patella-diagnose writes it");
  };
  if (!json.is_object() || !json.contains("excitation") || !json["excitation"].is_object()) {
    throw expected("no 'excitation', expected a diagnosis.json");
  }
  Unrevealed unrevealed;
  try {
    const nlohmann::json& excitation = json["excitation"];
    const std::size_t found = excitation.at("position_range_rad").size();
    if (found != static_cast<std::size_t>(joints)) {
      throw app::FileError(fmt::format("{}: a diagnosis of {} joint{}, expected {}, as the model has",
                                       diagnosis_json.string(), found, found == 1 ? "" : "s", joints));
    }
    std::vector<std::string> found_effects;
    for (const nlohmann::json& effect : json.at("effects")) {
      found_effects.push_back(
          fmt::format("{}@{}", effect.at("kind").get<std::string>(), effect.at("joint").get<int>()));
    }
    unrevealed.effects = effectsToShow(
        found_effects, excitation.at("not_identifiable").get<std::vector<std::string>>(), joints);
    for (const nlohmann::json& rest : json.at("rest")) {
      unrevealed.noise.push_back({.noise_Nm = rest.at("noise").get<double>(),
                                  .structure_Nm = rest.at("beyond_noise").get<double>()});
    }
  } catch (const nlohmann::json::exception&) {
    throw expected(
        "effects, excitation.position_range_rad, excitation.not_identifiable or rest is missing or of "
        "another "
        "form, expected lists");
  }
  if (unrevealed.noise.size() != static_cast<std::size_t>(joints)) {
    unrevealed.noise.clear();
  }
  return unrevealed;
}

}  // namespace patella::diagnose
