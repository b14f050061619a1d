#include "tools/train/score.hpp"

#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "core/network/attention_lstm.hpp"

namespace patella::train {
namespace {

void add(Errors& errors, const Rows& estimate, const Rows& reference, Eigen::Index step) {
  for (Eigen::Index joint = 0; joint < reference.cols(); ++joint) {
    const double error = estimate(step, joint) - reference(step, joint);
    errors.mean_absolute[static_cast<std::size_t>(joint)] += std::abs(error);
    errors.rms[static_cast<std::size_t>(joint)] += error * error;
  }
}

void finish(Errors& errors, std::size_t steps) {
  const auto count = static_cast<double>(steps);
  for (std::size_t joint = 0; joint < errors.rms.size(); ++joint) {
    errors.mean_absolute[joint] /= count;
    errors.rms[joint] = std::sqrt(errors.rms[joint] / count);
  }
}

}  // namespace

Rows deliveredOf(const network::NetworkWeights& weights, const Sequence& sequence) {
  network::AttentionLstm network(weights);
  Rows delivered(sequence.steps(), sequence.reference.cols());
  for (Eigen::Index step = 0; step < sequence.steps(); ++step) {
    const Eigen::VectorXd row = sequence.features.row(step).transpose();
    delivered.row(step) = network.step({row.data(), static_cast<std::size_t>(row.size())}).transpose();
    network.prepare();
  }
  return isCorrection(weights.output) ? Rows(delivered + sequence.observer) : delivered;
}

Score scoreOf(const network::NetworkWeights& weights, std::span<const Sequence> sequences, Role role) {
  if (role != Role::kTest && role != Role::kValidation) {
    throw std::invalid_argument("a score on data that were trained on says nothing, expected held-out data");
  }
  Score score;
  for (const Sequence& sequence : sequences) {
    if (std::find(sequence.role.begin(), sequence.role.end(), role) == sequence.role.end()) {
      continue;
    }
    const Rows delivered = deliveredOf(weights, sequence);
    score.joints = static_cast<std::size_t>(delivered.cols());
    const Rows zero = Rows::Zero(delivered.rows(), delivered.cols());
    for (Eigen::Index step = 0; step < sequence.steps(); ++step) {
      if (sequence.role[static_cast<std::size_t>(step)] == role) {
        ++score.steps;
        add(score.network, delivered, sequence.reference, step);
        add(score.observer, sequence.observer, sequence.reference, step);
        add(score.zero, zero, sequence.reference, step);
      }
    }
  }
  for (Errors* errors : {&score.network, &score.observer, &score.zero}) {
    finish(*errors, score.steps);
  }
  return score;
}

std::string unitOf(network::OutputKind output) {
  return isTorque(output) ? "N·m" : "rad/s²";
}

std::string scoreText(const Score& score, network::OutputKind output) {
  std::string text = fmt::format("  {:<34}{:>12}{:>12}{:>12}\n",
                                 fmt::format("{} steps, errors in {}", score.steps, unitOf(output)),
                                 "network", "observer", "nothing");
  for (std::size_t joint = 0; joint < score.joints; ++joint) {
    if (score.zero.rms[joint] == 0.0) {
      continue;
    }
    text += fmt::format("  {:<34}{:>12.4g}{:>12.4g}{:>12.4g}\n",
                        fmt::format("joint {} mean absolute", joint + 1), score.network.mean_absolute[joint],
                        score.observer.mean_absolute[joint], score.zero.mean_absolute[joint]);
    text += fmt::format("  {:<34}{:>12.4g}{:>12.4g}{:>12.4g}\n", fmt::format("joint {} rms", joint + 1),
                        score.network.rms[joint], score.observer.rms[joint], score.zero.rms[joint]);
  }
  return text;
}

}  // namespace patella::train
