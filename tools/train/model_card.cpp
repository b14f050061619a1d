#include "tools/train/model_card.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/json_file.hpp"
#include "firmware_app/weights/network_weights_file.hpp"

namespace patella::train {
namespace {

constexpr const char* kDataKey = "card_data";
constexpr const char* kTraining = "training";

nlohmann::json errorsJson(const Errors& errors, std::size_t joints) {
  return {{"mean_absolute",
           std::vector<double>(errors.mean_absolute.begin(),
                               errors.mean_absolute.begin() + static_cast<std::ptrdiff_t>(joints))},
          {"rms", std::vector<double>(errors.rms.begin(),
                                      errors.rms.begin() + static_cast<std::ptrdiff_t>(joints))}};
}

std::string testText(const std::optional<Score>& test) {
  if (!test) {
    return "none: nothing was held out";
  }
  return nlohmann::json{{"steps", test->steps},
                        {"network", errorsJson(test->network, test->joints)},
                        {"observer", errorsJson(test->observer, test->joints)},
                        {"nothing", errorsJson(test->zero, test->joints)}}
      .dump();
}

std::string optionsText(const TrainingOptions& o) {
  return nlohmann::json{{"batch", o.batch},
                        {"burn_in_steps", o.burn_in},
                        {"epochs", o.epochs},
                        {"initialisation", initialisationNames()[static_cast<std::size_t>(o.initialisation)]},
                        {"learning_rate", o.learning_rate},
                        {"linear_lags", o.linear_lags},
                        {"linear_loss", o.linear_loss == Loss::kSquared ? "squared" : "absolute"},
                        {"loss", o.loss == Loss::kSquared ? "squared" : "absolute"},
                        {"patience", o.patience},
                        {"seed", o.seed},
                        {"sequence_steps", o.sequence_steps},
                        {"stopping", stoppingNames()[static_cast<std::size_t>(o.stopping)]},
                        {"threads", o.threads},
                        {"turn_s", o.turn_s},
                        {"weight_decay", o.weight_decay}}
      .dump();
}

std::string curveText(const std::vector<Epoch>& curve) {
  nlohmann::json losses = nlohmann::json::array();
  for (const Epoch& epoch : curve) {
    losses.push_back({epoch.training, epoch.validation});  // NaN becomes null
  }
  return losses.dump();
}

}  // namespace

std::vector<UsedRecording> usesOf(std::span<const Sequence> sequences) {
  std::vector<UsedRecording> uses;
  const auto has = [](const Sequence& sequence, Role role) {
    return std::find(sequence.role.begin(), sequence.role.end(), role) != sequence.role.end();
  };
  for (const Sequence& sequence : sequences) {
    const std::string use = has(sequence, Role::kTrain)        ? kTraining
                            : has(sequence, Role::kValidation) ? "validation"
                                                               : "test";
    const auto known = std::find_if(uses.begin(), uses.end(),
                                    [&](const auto& used) { return used.sha256 == sequence.sha256; });
    if (known == uses.end()) {
      uses.push_back({sequence.name, sequence.sha256, use});
    } else if (use == kTraining) {
      known->use = use;
    }
  }
  return uses;
}

std::map<std::string, std::string> metadataOf(const ModelCard& card) {
  nlohmann::json data = nlohmann::json::array();
  for (const UsedRecording& used : card.data) {
    const std::filesystem::path path(used.name);
    // With its folder: every run of the loop leaves a ticks.csv.
    data.push_back({{"file", (path.parent_path().filename() / path.filename()).string()},
                    {"sha256", used.sha256},
                    {"use", used.use}});
  }
  return {{kDataKey, data.dump()},
          {"card_config_sha256", card.config_sha256},
          {app::kModelDigest, card.model_sha256},
          {"card_split", card.split},
          {"card_target", targetNames()[static_cast<std::size_t>(card.target)]},
          {"horizon_s", fmt::format("{}", card.horizon_s)},
          {"card_options", optionsText(card.options)},
          {"card_curve", curveText(card.curve)},
          {"card_kept_epoch", std::to_string(card.kept_epoch)},
          {"card_stopped_by", card.stopped_by},
          {"card_test", testText(card.test)}};
}

std::vector<UsedRecording> dataOf(const std::filesystem::path& weights,
                                  const std::map<std::string, std::string>& metadata) {
  const auto found = metadata.find(kDataKey);
  if (found == metadata.end()) {
    throw app::FileError(
        weights.string() + ": metadata '" + kDataKey +
        "': missing, expected the recordings it was trained on; without them no score is given");
  }
  try {
    std::vector<UsedRecording> data;
    for (const auto& entry :
         app::parseJson(found->second, weights.string() + ": metadata '" + kDataKey + "'")) {
      data.push_back({entry.at("file"), entry.at("sha256"), entry.at("use")});
    }
    return data;
  } catch (const nlohmann::json::exception& error) {
    throw app::FileError(weights.string() + ": metadata '" + kDataKey + "': " + error.what());
  }
}

void refuseTrained(std::span<const UsedRecording> known, const std::string& name, const std::string& sha256) {
  for (const UsedRecording& used : known) {
    if (used.sha256 == sha256 && used.use == kTraining) {
      throw std::invalid_argument(name + ": the network was trained on it (as " + used.name + ", SHA-256 " +
                                  sha256 + "), expected a recording that it has not seen: no score is given");
    }
  }
}

}  // namespace patella::train
