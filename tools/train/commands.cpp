#include "tools/train/commands.hpp"

#include <chrono>
#include <ostream>
#include <set>
#include <stdexcept>

#include <fmt/format.h>
#include <unistd.h>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "firmware_app/weights/safetensors_file.hpp"
#include "tools/train/curves.hpp"
#include "tools/train/model_card.hpp"
#include "tools/train/output_files.hpp"

namespace patella::train {
namespace {

namespace fs = std::filesystem;
using diagnose::Recording;

/// On a terminal one line that changes, elsewhere one every few seconds.
class ProgressLine {
 public:
  void show(const Progress& p) {
    using namespace std::chrono_literals;
    const auto now = std::chrono::steady_clock::now();
    const bool last = p.epoch == p.epochs;
    if (!last && now < next_) {
      return;
    }
    next_ = now + (terminal_ ? 200ms : 5000ms);
    fmt::print(stderr, "{}epoch {}/{}  loss {:.3e}  validation {:.3e}  {:.2f} epochs/s  {:.0f} s left{}",
               terminal_ ? "\r\033[K" : "", p.epoch, p.epochs, p.losses.training, p.losses.validation,
               p.epochs_per_s, p.left_s, terminal_ && !last ? "" : "\n");
  }

 private:
  bool terminal_ = isatty(STDERR_FILENO) == 1;
  std::chrono::steady_clock::time_point next_{};
};

app::RunConfig loadConfig(Arguments& a) {
  app::CommandLine command_line;
  command_line.config = a.config;
  command_line.backend = "sim";  // whatever bus it is made for, nothing is opened
  command_line.clock = "virtual";
  app::RunConfig config = app::loadRunConfig(command_line);
  a.recording.joints = config.model.joints();
  a.recording.bus_map = config.bus_map_path;
  a.recording.truth = a.target == "truth";
  return config;
}

/// Each file once: the same data under two names, or for two uses, would be scored on what was trained on.
class Loader {
 public:
  explicit Loader(const diagnose::RecordingOptions& options) : options_(options) {}

  Recording load(const fs::path& path) {
    Recording recording = diagnose::loadRecording(path, options_);
    if (!seen_.insert(recording.sha256).second) {
      throw std::invalid_argument(path.string() + ": its data were given before (SHA-256 " +
                                  recording.sha256 + "), expected each recording once");
    }
    for (const std::string& warning : recording.warnings) {
      fmt::print(stderr, "{}: {}\n", path.string(), warning);
    }
    return recording;
  }

 private:
  diagnose::RecordingOptions options_;
  std::set<std::string> seen_;
};

PreparationOptions preparationOf(const Arguments& a) {
  return {.features = a.features,
          .target = static_cast<Target>(std::find(targetNames().begin(), targetNames().end(), a.target) -
                                        targetNames().begin()),
          .output = outputOf(a),
          .rate_Hz = a.rate_Hz,
          .horizon_s = 1e-3 * a.horizon_ms,
          .smoothing_Hz = a.smoothing_Hz};
}

void nameFeatures(Arguments& a, PreparationOptions& options, const std::vector<Recording>& recordings) {
  const int joints = a.recording.joints;
  const bool has_emg = std::any_of(recordings.begin(), recordings.end(), [](const Recording& recording) {
    return std::any_of(recording.activation.begin(), recording.activation.end(),
                       [](const auto& channel) { return !channel.empty(); });
  });
  if (a.features == std::vector<std::string>{"paper"}) {
    options.features = paperFeatures(joints);
  } else if (a.features == std::vector<std::string>{"deployable"}) {
    options.features = deployableFeatures(joints, has_emg);
  }
}

struct Material {
  std::vector<Sequence> sequences;
  PreparationOptions preparation;
};

Material prepareAll(Arguments& a, const app::RunConfig& config) {
  Loader loader(a.recording);
  std::vector<Recording> recordings;
  for (const auto* group : {&a.data, &a.validation_data, &a.test_data}) {
    for (const fs::path& path : *group) {
      recordings.push_back(loader.load(path));
    }
  }
  Material material{.sequences = {}, .preparation = preparationOf(a)};
  nameFeatures(a, material.preparation, recordings);
  std::vector<Sequence> elsewhere;
  for (std::size_t i = 0; i < recordings.size(); ++i) {
    for (Sequence& sequence : prepare(recordings[i], config, material.preparation)) {
      if (i < a.data.size()) {
        material.sequences.push_back(std::move(sequence));
        continue;
      }
      const bool validates = i < a.data.size() + a.validation_data.size();
      assignRole(sequence, validates ? Role::kValidation : Role::kTest, a.split.settling_s);
      elsewhere.push_back(std::move(sequence));
    }
  }
  assignRoles(material.sequences, a.split);
  std::move(elsewhere.begin(), elsewhere.end(), std::back_inserter(material.sequences));
  return material;
}

std::string splitText(const Arguments& a) {
  std::string text = fmt::format(
      "{}, validation {}, test {}, seed {}", a.split_name,
      a.validation_data.empty() ? fmt::format("{}", a.split.validation_share)
                                : std::string("on recordings of its own"),
      a.test_data.empty() ? fmt::format("{}", a.split.test_share) : std::string("on recordings of its own"),
      a.split.seed);
  if (a.split.kind == SplitKind::kBlocked) {
    text += fmt::format(", blocks of {} s", a.split.block_s);
  }
  return text;
}

}  // namespace

void fit(Arguments& a, std::ostream& out) {
  understand(a);
  const OutputFiles files = outputFiles(a.weights, a.curves);
  const app::RunConfig config = loadConfig(a);
  const Material material = prepareAll(a, config);
  const std::vector<Sequence>& sequences = material.sequences;
  const network::NetworkWeights frame = frameOf(sequences, material.preparation.features, outputOf(a));
  out << fmt::format("{} steps to train on, {} for validation, {} for the test\n",
                     countOf(sequences, Role::kTrain), countOf(sequences, Role::kValidation),
                     countOf(sequences, Role::kTest));
  ProgressLine line;
  const Trained trained =
      trainNetwork(sequences, frame, a.training,
                   {.checkpoint = files.checkpoint, .progress = [&](const Progress& p) { line.show(p); }});

  ModelCard card{.data = usesOf(sequences),
                 .config_sha256 = app::fileSha256(config.path),
                 .model_sha256 = app::fileSha256(config.model_path),
                 .split = splitText(a),
                 .target = material.preparation.target,
                 .horizon_s = material.preparation.horizon_s,
                 .options = a.training,
                 .curve = trained.curve,
                 .kept_epoch = trained.kept_epoch,
                 .stopped_by = trained.stopped_by,
                 .test = {}};
  if (countOf(sequences, Role::kTest) > 0) {
    card.test = scoreOf(trained.weights, sequences, Role::kTest);
  }
  auto metadata = metadataOf(card);
  metadata["card_program"] =
      std::string("patella-train ") + PATELLA_VERSION + ", libtorch " + PATELLA_TORCH_VERSION;
  app::saveNetworkWeights(files.weights, trained.weights, metadata);
  fs::remove(files.checkpoint);
  out << fmt::format(
      "ended after {} epochs ({}); {} kept\n", trained.curve.size(), trained.stopped_by,
      trained.kept_epoch == 0 ? std::string("linear start") : fmt::format("epoch {}", trained.kept_epoch));
  out << (card.test ? scoreText(*card.test, outputOf(a))
                    : std::string("  nothing was held out for a test: no score is given\n"));
  out << fmt::format("  weights in {}\n", files.weights.string()) << std::flush;
  // Last: the weights are there, and their score is told, also where no picture can be drawn.
  drawCurves(trained.curve, trained.kept_epoch, "Training of " + files.weights.filename().string(),
             files.curves);
  out << fmt::format("  curves in {}\n", files.curves.string());
}

void score(Arguments& a, std::ostream& out) {
  understand(a);
  const app::RunConfig config = loadConfig(a);
  const network::NetworkWeights weights = app::loadNetworkWeights(a.weights);
  const auto metadata = app::readSafetensors(a.weights).metadata;
  const std::vector<UsedRecording> known = dataOf(a.weights, metadata);
  PreparationOptions options = preparationOf(a);
  options.features = weights.features;
  options.output = weights.output;
  options.rate_Hz = weights.rate_Hz;
  const auto horizon = metadata.find("horizon_s");
  options.horizon_s = horizon == metadata.end() ? 0.0 : std::stod(horizon->second);
  Loader loader(a.recording);
  std::vector<Sequence> sequences;
  for (const fs::path& path : a.data) {
    const Recording recording = loader.load(path);
    refuseTrained(known, path.string(), recording.sha256);
    for (Sequence& sequence : prepare(recording, config, options)) {
      assignRole(sequence, Role::kTest, a.split.settling_s);
      sequences.push_back(std::move(sequence));
    }
  }
  out << scoreText(scoreOf(weights, sequences, Role::kTest), weights.output);
}

void seal(const fs::path& weights, std::ostream& out) {
  const app::Safetensors content = app::readSafetensors(weights);
  if (content.sealed) {
    out << fmt::format("{}: has a digest already, and it is right\n", weights.string());
    return;
  }
  app::writeSafetensors(weights, content);
  out << fmt::format("{}: digest {}\n", weights.string(), app::contentSha256(content));
}

}  // namespace patella::train
