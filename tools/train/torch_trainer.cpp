#include <chrono>
#include <cmath>
#include <limits>
#include <numbers>

#include <ATen/Parallel.h>
#include <fmt/format.h>

#include "tools/train/early_stopping.hpp"
#include "tools/train/linear_path.hpp"
#include "tools/train/split.hpp"
#include "tools/train/spread_gates.hpp"
#include "tools/train/torch_checkpoint.hpp"
#include "tools/train/torch_network.hpp"
#include "tools/train/windows.hpp"

namespace patella::train {
namespace {

constexpr double kLastRate = 0.01;  // of the first

/// A sequence as the network works on it.
struct Prepared {
  torch::Tensor input;     ///< steps x features, normalised
  torch::Tensor target;    ///< steps x outputs, normalised, less the linear path, which is not trained
  torch::Tensor train;     ///< steps, 1 where it is trained on
  torch::Tensor validate;  ///< likewise
};

struct Batch {
  torch::Tensor input;
  torch::Tensor target;
  torch::Tensor weight;
};

torch::Tensor maskOf(const std::vector<Role>& roles, Role wanted) {
  torch::Tensor mask = torch::zeros({static_cast<std::int64_t>(roles.size())});
  for (std::size_t i = 0; i < roles.size(); ++i) {
    mask.data_ptr<float>()[i] = roles[i] == wanted ? 1.0F : 0.0F;
  }
  return mask;
}

class Training {
 public:
  Training(std::span<const Sequence> sequences, const network::NetworkWeights& frame,
           const TrainingOptions& options)
      : sequences_(sequences),
        frame_(framed(sequences, frame, options)),
        options_(options),
        network_(frame_) {
    network::NetworkWeights of_target;
    of_target.feature_mean = frame.output_mean;
    of_target.feature_scale = frame.output_scale;
    const torch::NoGradGuard no_gradients;
    for (const Sequence& sequence : sequences) {
      const torch::Tensor input = normalised(sequence.features, frame_);
      const torch::Tensor linear = network_.linearPath(input.unsqueeze(0)).squeeze(0);
      prepared_.push_back({input, normalised(targetOf(sequence, frame.output), of_target) - linear,
                           maskOf(sequence.role, Role::kTrain), maskOf(sequence.role, Role::kValidation)});
    }
    std::vector<Window> whole;
    for (std::size_t s = 0; s < sequences.size(); ++s) {
      if (countOf(sequences.subspan(s, 1), Role::kValidation) > 0) {
        whole.push_back({.sequence = s, .begin = 0, .count = sequences[s].steps(), .burn_in = 0});
      }
    }
    validation_ = batchOf(whole, &Prepared::validate);
  }

  TrainingState start() {
    NamedTensors kept;
    for (auto& [name, tensor] : network_.parameters()) {
      // The linear path stays as it was found: steps of one size for all weights blur its small differences
      // of large inputs.
      tensor.requires_grad_(!name.starts_with("linear."));
      kept.emplace_back(name, tensor.detach().clone());
    }
    return {network_.parameters(), kept, Adam(network_.parameters()), {}};
  }

  /// One pass over the data; which one decides about order and rate alone, so that a resumed training sees
  /// what the interrupted one would have seen.
  Epoch epoch(TrainingState& state, std::size_t number) {
    sim::Random random(options_.seed, 1 + number);
    const std::vector<Window> windows =
        drawWindows(sequences_, options_.sequence_steps, options_.burn_in, random);
    const auto size = static_cast<std::size_t>(options_.batch);
    double loss_sum = 0.0;
    double weight_sum = 0.0;
    for (std::size_t first = 0; first < windows.size(); first += size) {
      const auto drawn = std::span(windows).subspan(first, std::min(size, windows.size() - first));
      const Batch batch = batchOf(drawn, &Prepared::train);
      const double weight = batch.weight.sum().item<double>();
      const torch::Tensor loss =
          lossOf(network_.recurrentPath(batch.input), batch.target, batch.weight) / weight;
      loss.backward();
      const double done =
          (static_cast<double>(number) + static_cast<double>(first) / static_cast<double>(windows.size())) /
          options_.epochs;
      state.adam.step(state.parameters, rateAt(done), options_.weight_decay);
      loss_sum += weight * loss.item<double>();
      weight_sum += weight;
    }
    return {loss_sum / weight_sum, validationLoss()};
  }

  /// True where the linear path alone does as well on validation: what was learned beside it betters the mean
  /// over sequences by less than its standard error. The best of many passes flatters itself by about as
  /// much.
  bool startSuffices(const network::NetworkWeights& learned) const {
    if (frame_.linear_lags.empty() || validation_.weight.numel() == 0) {
      return false;
    }
    const torch::Tensor gain =
        validationLosses(TorchNetwork(frame_)) - validationLosses(TorchNetwork(learned));
    const auto count = static_cast<double>(gain.numel());
    const double spread = count > 1.0 ? gain.std().item<double>() / std::sqrt(count) : 0.0;
    return gain.mean().item<double>() <= spread;
  }

  const network::NetworkWeights& startWeights() const noexcept { return frame_; }

  network::NetworkWeights weights(const NamedTensors& parameters) {
    const torch::NoGradGuard no_gradients;
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      network_.parameters()[i].second.copy_(parameters[i].second);
    }
    return network_.weights();
  }

 private:
  static network::NetworkWeights framed(std::span<const Sequence> sequences, network::NetworkWeights frame,
                                        const TrainingOptions& options) {
    frame.heads = options.heads;
    frame.window = options.window;
    frame.attention_scale = options.attention_scale;
    frame.linear_lags = options.linear_lags;
    initialise(frame,
               {.inputs = frame.feature_mean.size(),
                .hidden = options.hidden,
                .layers = options.layers,
                .channels = options.channels,
                .outputs = frame.output_mean.size()},
               options.seed);
    if (options.initialisation == Initialisation::kSpread) {
      spreadGates(frame, sequences, options.turn_s, options.seed);
    }
    if (!frame.linear_lags.empty()) {
      fitLinearPath(frame, sequences, options.linear_loss);
    }
    network::checkWeights(frame);
    return frame;
  }

  double rateAt(double done) const {
    const double half_cosine = 0.5 * (1.0 + std::cos(std::numbers::pi * done));
    return options_.learning_rate * (kLastRate + (1.0 - kLastRate) * half_cosine);
  }

  Batch batchOf(std::span<const Window> windows, torch::Tensor Prepared::*mask) const {
    Eigen::Index longest = 0;
    for (const Window& window : windows) {
      longest = std::max(longest, window.count);
    }
    const auto count = static_cast<std::int64_t>(windows.size());
    Batch batch{torch::zeros({count, longest, frame_.feature_mean.size()}),
                torch::zeros({count, longest, frame_.output_mean.size()}), torch::zeros({count, longest})};
    for (std::int64_t i = 0; i < count; ++i) {
      const Window& window = windows[static_cast<std::size_t>(i)];
      const Prepared& from = prepared_[window.sequence];
      const std::int64_t end = window.begin + window.count;
      batch.input[i].slice(0, 0, window.count).copy_(from.input.slice(0, window.begin, end));
      batch.target[i].slice(0, 0, window.count).copy_(from.target.slice(0, window.begin, end));
      batch.weight[i]
          .slice(0, window.burn_in, window.count)
          .copy_((from.*mask).slice(0, window.begin + window.burn_in, end));
    }
    return batch;
  }

  /// Sum over steps of the mean over outputs.
  torch::Tensor lossOf(const torch::Tensor& output, const torch::Tensor& target,
                       const torch::Tensor& weight) const {
    const torch::Tensor error = output - target;
    return ((options_.loss == Loss::kSquared ? error.square() : error.abs()).mean(-1) * weight).sum();
  }

  /// Over whole sequences, as the loop would run them, all side by side.
  double validationLoss() const {
    const torch::NoGradGuard no_gradients;
    if (validation_.weight.numel() == 0) {
      return std::numeric_limits<double>::quiet_NaN();
    }
    const torch::Tensor loss =
        lossOf(network_.recurrentPath(validation_.input), validation_.target, validation_.weight);
    return loss.item<double>() / validation_.weight.sum().item<double>();
  }

  /// Mean loss of each sequence by itself.
  torch::Tensor validationLosses(const TorchNetwork& network) const {
    const torch::NoGradGuard no_gradients;
    const torch::Tensor error = network.recurrentPath(validation_.input) - validation_.target;
    const torch::Tensor losses = (options_.loss == Loss::kSquared ? error.square() : error.abs()).mean(-1);
    return (losses * validation_.weight).sum(-1) / validation_.weight.sum(-1);
  }

  std::span<const Sequence> sequences_;
  network::NetworkWeights frame_;
  TrainingOptions options_;
  TorchNetwork network_;
  std::vector<Prepared> prepared_;
  Batch validation_;
};

void keep(TrainingState& state) {
  const torch::NoGradGuard no_gradients;
  for (std::size_t i = 0; i < state.kept.size(); ++i) {
    state.kept[i].second.copy_(state.parameters[i].second);
  }
}

std::string reasonFor(const TrainingOptions& options, bool enough) {
  if (!enough) {
    return fmt::format("{} epochs", options.epochs);
  }
  return options.stopping == Stopping::kPaper
             ? "training loss changed by less than 0.1 % in five epochs"
             : fmt::format("no better validation loss for {} epochs", options.patience);
}

}  // namespace

Trained trainNetwork(std::span<const Sequence> sequences, const network::NetworkWeights& frame,
                     const TrainingOptions& options, const Surroundings& surroundings) {
  using Clock = std::chrono::steady_clock;
  at::set_num_threads(checked(options).threads);
  Training training(sequences, frame, options);
  TrainingState state = training.start();
  const std::string identity = identityOf(sequences, frame, options);
  if (surroundings.checkpoint && std::filesystem::exists(*surroundings.checkpoint)) {
    const torch::NoGradGuard no_gradients;
    loadCheckpoint(*surroundings.checkpoint, identity, state);
  }
  const auto begun = Clock::now();
  const std::size_t resumed = state.curve.size();
  const auto epochs = static_cast<std::size_t>(options.epochs);
  bool enough = !state.curve.empty() && isEnough(state.curve, options);
  while (!enough && state.curve.size() < epochs) {
    state.curve.push_back(training.epoch(state, state.curve.size()));
    if (keptEpoch(state.curve, options.stopping) + 1 == state.curve.size()) {
      keep(state);
    }
    enough = isEnough(state.curve, options);
    if (surroundings.checkpoint) {
      saveCheckpoint(*surroundings.checkpoint, identity, state);
    }
    if (surroundings.progress) {
      const double spent_s = std::chrono::duration<double>(Clock::now() - begun).count();
      const double per_s = static_cast<double>(state.curve.size() - resumed) / spent_s;
      surroundings.progress({.epoch = static_cast<int>(state.curve.size()),
                             .epochs = options.epochs,
                             .losses = state.curve.back(),
                             .epochs_per_s = per_s,
                             .left_s = static_cast<double>(epochs - state.curve.size()) / per_s});
    }
  }
  Trained trained{.weights = training.weights(state.kept),
                  .curve = state.curve,
                  .kept_epoch = 1 + static_cast<int>(keptEpoch(state.curve, options.stopping)),
                  .stopped_by = reasonFor(options, enough)};
  if (options.stopping == Stopping::kValidation && training.startSuffices(trained.weights)) {
    trained.weights = training.startWeights();
    trained.kept_epoch = 0;
  }
  return trained;
}

}  // namespace patella::train
