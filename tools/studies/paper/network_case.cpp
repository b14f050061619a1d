#include "tools/studies/paper/network_case.hpp"

#include <chrono>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "tools/train/score.hpp"

namespace patella::study {
namespace {

using nlohmann::json;
using train::Role;

constexpr std::uint64_t kUnseenSeed = 1000;  // and on: of motions that no training sees
constexpr const char* kWeights = ".safetensors";
constexpr const char* kCheckpoint = ".checkpoint";

std::string networkSettings(const PaperOptions& options) {
  const train::TrainingOptions& t = options.training;
  return fmt::format(
      "{} s at {} Hz, test share {}, tuned on {} seeds, layers {}, hidden {}, channels {}, heads {}, window "
      "{}, "
      "attention scale {}, initialisation {}, turn {} s, loss {}, stopping {}, epochs {}, batch {}, steps "
      "{}, "
      "burn-in {}, learning rate {}, weight decay {}",
      options.seconds, options.rate_Hz, options.test_share, options.tuning_seeds, t.layers, t.hidden,
      t.channels, t.heads, t.window, static_cast<int>(t.attention_scale),
      train::initialisationNames()[static_cast<std::size_t>(t.initialisation)], t.turn_s,
      static_cast<int>(t.loss), train::stoppingNames()[static_cast<std::size_t>(t.stopping)], t.epochs,
      t.batch, t.sequence_steps, t.burn_in, t.learning_rate, t.weight_decay);
}

NetworkScore scoreOf(const std::string& tested_on, const Material& material,
                     const network::NetworkWeights& weights) {
  const std::vector<Role>& role = material.sequence.role;
  return {.tested_on = tested_on,
          .network = meanOverTest(deliveredOf(weights, material.sequence) - material.truth, role),
          .target = meanOverTest(material.sequence.reference - material.truth, role),
          .nothing = meanOverTest(material.truth, role)};
}

json jsonOf(const NetworkCase& one) {
  json scores = json::array();
  for (const NetworkScore& score : one.scores) {
    scores.push_back({{"tested_on", score.tested_on},
                      {"network", score.network},
                      {"target", score.target},
                      {"nothing", score.nothing}});
  }
  json curve = json::array();
  for (const train::Epoch& epoch : one.curve) {
    curve.push_back(epoch.training);
  }
  return {{"unit", one.condition.corrected ? "N·m" : "rad/s²"},
          {"scores", scores},
          {"curve", curve},
          {"output_scale", one.output_scale},
          {"training_s", one.training_s}};
}

}  // namespace

std::string fileName(const Condition& condition, train::SplitKind split, std::uint64_t seed) {
  return fmt::format("{}_{}_{}_seed{}", condition.corrected ? "corrected" : "as_printed",
                     numberOf(condition.experiment), train::splitNames()[static_cast<std::size_t>(split)],
                     seed);
}

Material materialOfCase(const PaperOptions& options, const Condition& condition, train::SplitKind split,
                        std::uint64_t seed, std::span<const double> target_values) {
  Material material = materialOf(record(condition, options.seconds, seed), target_values, options.rate_Hz);
  assignRoles(std::span(&material.sequence, 1), splitOf(options, split, seed));
  return material;
}

Material materialOfUnseen(const PaperOptions& options, const Condition& condition, Unseen unseen,
                          std::uint64_t seed, std::span<const double> target_values) {
  Condition other = condition;
  other.push_begun_s = unseen == Unseen::kPush ? kEarlier_s : 0.0;
  Material material =
      materialOf(record(other, options.seconds, kUnseenSeed + seed), target_values, options.rate_Hz);
  assignRole(material.sequence, Role::kTest, kSettling_s);
  return material;
}

std::optional<NetworkCase> findCase(const KeptResults& kept, const PaperOptions& options,
                                    const Condition& condition, train::SplitKind split, std::uint64_t seed) {
  const std::string name = fileName(condition, split, seed);
  const std::optional<json> found = kept.find(name, networkSettings(options));
  if (!found) {
    return std::nullopt;
  }
  NetworkCase one{
      .condition = condition, .split = split, .seed = seed, .scores = {}, .curve = {}, .weights = {}};
  try {
    for (const json& score : found->at("scores")) {
      NetworkScore& last = one.scores.emplace_back();
      score.at("tested_on").get_to(last.tested_on);
      score.at("network").get_to(last.network);
      score.at("target").get_to(last.target);
      score.at("nothing").get_to(last.nothing);
    }
    for (const json& loss : found->at("curve")) {
      one.curve.push_back({.training = loss.get<double>()});
    }
    found->at("output_scale").get_to(one.output_scale);
    found->at("training_s").get_to(one.training_s);
  } catch (const json::exception& error) {
    throw app::FileError(kept.beside(name, ".json").string() + ": damaged: " + error.what() +
                         "; remove it to have it made anew");
  }
  one.weights = app::loadNetworkWeights(kept.beside(name, kWeights));
  return one;
}

NetworkCase trainCase(const KeptResults& kept, const PaperOptions& options, const Condition& condition,
                      train::SplitKind split, std::uint64_t seed, std::span<const double> target_values,
                      const std::function<void(const train::Progress&)>& progress) {
  const std::string name = fileName(condition, split, seed);
  const Material material = materialOfCase(options, condition, split, seed, target_values);
  const network::NetworkWeights frame = paperFrame(material, condition);
  train::TrainingOptions training = options.training;
  training.seed = seed;
  const std::filesystem::path checkpoint = kept.beside(name, kCheckpoint);
  const auto begun = std::chrono::steady_clock::now();
  const train::Trained trained = trainNetwork(std::span(&material.sequence, 1), frame, training,
                                              {.checkpoint = checkpoint, .progress = progress});
  const double training_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  NetworkCase one{
      .condition = condition,
      .split = split,
      .seed = seed,
      .scores = {scoreOf(train::splitNames()[static_cast<std::size_t>(split)], material, trained.weights)},
      .curve = trained.curve,
      .output_scale = frame.output_scale[0],
      .training_s = training_s,
      .weights = trained.weights};
  if (split == train::SplitKind::kRandom) {
    for (const Unseen unseen : {Unseen::kTrajectory, Unseen::kPush}) {
      one.scores.push_back(scoreOf(nameOf(unseen),
                                   materialOfUnseen(options, condition, unseen, seed, target_values),
                                   trained.weights));
    }
  }
  app::saveNetworkWeights(kept.beside(name, kWeights), trained.weights);
  kept.keep(name, networkSettings(options), jsonOf(one));
  std::filesystem::remove(checkpoint);
  return one;
}

}  // namespace patella::study
