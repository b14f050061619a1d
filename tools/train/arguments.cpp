#include "tools/train/arguments.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "tools/options/number_range.hpp"
#include "tools/train/linear_path.hpp"

namespace patella::train {
namespace {

constexpr std::array<const char*, 4> kOutputs = {"acceleration", "torque", "acceleration_correction",
                                                 "torque_correction"};

template <typename Kind>
Kind positionOf(const std::string& name, const std::vector<std::string>& names) {
  return static_cast<Kind>(std::find(names.begin(), names.end(), name) - names.begin());
}

void declareInput(CLI::App& app, Arguments& a) {
  app.add_option("--config", a.config,
                 "configuration of the loop that will run the network: model, observer, filters, bus")
      ->required();
  app.add_option("--columns", a.recording.columns,
                 "map of the columns of a text or MATLAB file that names them its own way, TOML");
  app.add_option("--dbc", a.recording.dbc,
                 "bus description of logs of frames, in place of the configuration's")
      ->check(CLI::ExistingFile);
  app.add_option("--torque", a.torque_timing,
                 "held: until the next sample; sampled: what acted at the sample; before: since the sample "
                 "before; as "
                 "the form of the file says unless given")
      ->check(CLI::IsMember(diagnose::torqueTimingNames()));
}

void declareTask(CLI::App& app, Arguments& a) {
  app.add_option("--features", a.features,
                 "paper (angles, velocities, time), deployable (no time), or names separated by commas")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option(
         "--output", a.output,
         "what the network says; a correction is added to the observer. Unless given: acceleration for "
         "features paper, torque_correction otherwise")
      ->check(CLI::IsMember(std::vector<std::string>(kOutputs.begin(), kOutputs.end())));
  app.add_option(
         "--target", a.target,
         "what is taken for the truth: the observer's f_s raw, filtered or smoothed offline; truth: f_u as a "
         "simulated rig published it")
      ->check(CLI::IsMember(targetNames()))
      ->capture_default_str();
  app.add_option(
         "--smoothing-Hz", a.smoothing_Hz,
         "cutoff of the smoothed target where the observer is no Kalman filter; estimate_cutoff_Hz of the "
         "configuration unless given")
      ->check(options::positiveNumber());
  app.add_option("--horizon-ms", a.horizon_ms, "how far the network looks ahead")
      ->check(options::numberFrom(0.0, 1000.0))
      ->capture_default_str();
  app.add_option("--rate-Hz", a.rate_Hz, "steps of the network a second, a whole part of the encoder's rate")
      ->check(options::numberFrom(1.0, 20000.0))
      ->capture_default_str();
}

void declareSplit(CLI::App& app, Arguments& a) {
  app.add_option(
         "--split", a.split_name,
         "random: single steps by lot, as the paper; blocked; chronological; recording: whole ones by lot")
      ->check(CLI::IsMember(splitNames()))
      ->capture_default_str();
  app.add_option("--validation-share", a.split.validation_share, "of the steps")
      ->check(options::numberFrom(0.0, 0.8))
      ->capture_default_str();
  app.add_option("--test-share", a.split.test_share, "of the steps")
      ->check(options::numberFrom(0.0, 0.8))
      ->capture_default_str();
  app.add_option("--block-s", a.split.block_s, "length of the blocks of the split of that name")
      ->check(options::numberFrom(0.01, 1e4))
      ->capture_default_str();
  app.add_option("--validation-data", a.validation_data, "recordings in place of a share for validation");
  app.add_option("--test-data", a.test_data, "recordings in place of a share for the test");
}

void declareNetwork(CLI::App& app, Arguments& a) {
  TrainingOptions& t = a.training;
  app.add_option("--layers", t.layers, "of the LSTM, 1 or 2")->capture_default_str();
  app.add_option("--hidden", t.hidden, "width of each")->capture_default_str();
  app.add_option("--channels", t.channels, "of queries, keys and values together")->capture_default_str();
  app.add_option("--heads", t.heads, "a divisor of the channels")->capture_default_str();
  app.add_option("--window", t.window, "steps that attention sees; 1: no attention")->capture_default_str();
  app.add_option("--linear-lags", a.linear_lags,
                 "steps ago, separated by commas, whose features act on the output directly; none; usual: " +
                     fmt::format("{}", fmt::join(usualLags(), ",")) +
                     ". Unless given: none where time is a feature")
      ->delimiter(',');
  app.add_option("--linear-loss", a.linear_loss, "what that path makes least")
      ->check(CLI::IsMember({"squared", "absolute"}))
      ->capture_default_str();
  app.add_option("--attention-scale", a.attention_scale,
                 "of the scores: 1/sqrt(channels/heads), or none as printed")
      ->check(CLI::IsMember({"inv_sqrt", "none"}))
      ->capture_default_str();
}

void declareTraining(CLI::App& app, Arguments& a) {
  TrainingOptions& t = a.training;
  app.add_option("--stopping", a.stopping,
                 "none; paper: loss changed by less than 0.1 % in five epochs; validation: no better one for "
                 "--patience epochs, the best kept")
      ->check(CLI::IsMember(stoppingNames()))
      ->capture_default_str();
  app.add_option(
         "--initialisation", a.initialisation,
         "pytorch; spread: the first layer's gates turn all over the data, for features with absolute time")
      ->check(CLI::IsMember(initialisationNames()))
      ->capture_default_str();
  app.add_option("--turn-s", t.turn_s, "within which those gates turn as time passes")->capture_default_str();
  app.add_option("--loss", a.loss, "what the training makes least")
      ->check(CLI::IsMember({"squared", "absolute"}))
      ->capture_default_str();
  app.add_option("--patience", t.patience, "epochs without a better one, by --stopping validation")
      ->capture_default_str();
  app.add_option("--epochs", t.epochs, "at most")->capture_default_str();
  app.add_option("--batch", t.batch, "pieces in one step of the optimiser")->capture_default_str();
  app.add_option("--sequence-steps", t.sequence_steps, "of a piece, through which errors are propagated back")
      ->capture_default_str();
  app.add_option("--burn-in", t.burn_in, "first of them, which only fill the memory")->capture_default_str();
  app.add_option("--learning-rate", t.learning_rate, "of Adam, at the start")->capture_default_str();
  app.add_option("--weight-decay", t.weight_decay, "share of the weights that a step of rate 1 takes off")
      ->capture_default_str();
  app.add_option("--seed", t.seed, "of everything that is drawn by lot")->capture_default_str();
  app.add_option("--threads", t.threads, "the same number gives the same file")->capture_default_str();
}

/// Time that grows for ever leaves the range that was learned, and a line through it all the more.
bool knowsTime(const std::vector<std::string>& features) {
  return std::any_of(features.begin(), features.end(),
                     [](const std::string& name) { return name == "paper" || name == "time_s"; });
}

std::vector<int> lagsOf(const Arguments& a) {
  const auto word = [&](const char* text) { return a.linear_lags == std::vector<std::string>{text}; };
  if (word("usual") || (a.linear_lags.empty() && !knowsTime(a.features))) {
    return usualLags();
  }
  if (word("none")) {
    return {};
  }
  std::vector<int> lags;
  for (const std::string& text : a.linear_lags) {
    int lag = 0;
    const char* end = text.data() + text.size();
    const auto [stopped, error] = std::from_chars(text.data(), end, lag);
    if (error != std::errc() || stopped != end) {
      throw std::invalid_argument("linear_lags: value '" + text +
                                  "', expected steps, or usual or none alone");
    }
    lags.push_back(lag);
  }
  return lags;
}

}  // namespace

void declareFit(CLI::App& app, Arguments& a) {
  declareInput(app, a);
  app.add_option("--data", a.data, "run folders of the loop, CSV files or logs of frames")->required();
  app.add_option("--out", a.weights, "weights file for the loop; OUT.checkpoint beside it while it grows")
      ->required();
  app.add_option("--curves", a.curves, "picture of the losses, PNG; OUT with that ending unless given");
  declareTask(app, a);
  declareSplit(app, a);
  declareNetwork(app, a);
  declareTraining(app, a);
}

void declareScore(CLI::App& app, Arguments& a) {
  declareInput(app, a);
  app.add_option("--weights", a.weights, "made by patella-train")->required();
  app.add_option("--data", a.data, "recordings that it was not trained on")->required();
  app.add_option("--target", a.target, "what is taken for the truth")
      ->check(CLI::IsMember(targetNames()))
      ->capture_default_str();
  app.add_option("--smoothing-Hz", a.smoothing_Hz, "as of fit")->check(options::positiveNumber());
}

void understand(Arguments& a) {
  if (!a.torque_timing.empty()) {
    a.recording.torque_timing = diagnose::torqueTimingNamed(a.torque_timing);
  }
  a.split.kind = positionOf<SplitKind>(a.split_name, splitNames());
  a.split.seed = a.training.seed;
  a.split.gap_s = a.training.window / a.rate_Hz;
  a.split.validation_share = a.validation_data.empty() ? a.split.validation_share : 0.0;
  a.split.test_share = a.test_data.empty() ? a.split.test_share : 0.0;
  a.training.stopping = positionOf<Stopping>(a.stopping, stoppingNames());
  a.training.initialisation = positionOf<Initialisation>(a.initialisation, initialisationNames());
  a.training.loss = a.loss == "squared" ? Loss::kSquared : Loss::kAbsolute;
  a.training.attention_scale =
      a.attention_scale == "none" ? network::AttentionScale::kNone : network::AttentionScale::kInvSqrt;
  a.training.linear_loss = a.linear_loss == "squared" ? Loss::kSquared : Loss::kAbsolute;
  a.training.linear_lags = lagsOf(a);
  checked(a.training);
}

network::OutputKind outputOf(const Arguments& a) {
  const std::string name = !a.output.empty()                                 ? a.output
                           : a.features == std::vector<std::string>{"paper"} ? "acceleration"
                                                                             : "torque_correction";
  return static_cast<network::OutputKind>(std::find(kOutputs.begin(), kOutputs.end(), name) -
                                          kOutputs.begin());
}

}  // namespace patella::train
