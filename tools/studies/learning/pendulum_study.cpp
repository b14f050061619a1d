#include "tools/studies/learning/pendulum_study.hpp"

#include <cmath>

#include <fmt/format.h>

#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/motion_band.hpp"
#include "tools/studies/learning/tables.hpp"
#include "tools/train/score.hpp"
#include "tools/train/split.hpp"

namespace patella::study {
namespace {

using diagnose::Dataset;
using train::Role;
using train::Sequence;

const std::vector<std::string>& features() {
  static const std::vector<std::string> names = {"q1_rad",    "q2_rad",          "dq1_rad_s",
                                                 "dq2_rad_s", "ddq_hat1_rad_s2", "ddq_hat2_rad_s2"};
  return names;
}

/// One for each stretch, at the rate of the band; `reference` is what the model leaves of the torque.
std::vector<Sequence> sequencesOf(const Dataset& data, const model::ModelDescription& description) {
  model::DynamicsModel model = makeModel(description);
  const diagnose::Column residual = data.driveTorque() - data.modelTorque(model);
  std::vector<Eigen::VectorXd> columns;
  for (int joint = 0; joint < 2; ++joint) {
    columns.push_back(data.variable([joint](const auto& s, std::size_t i) { return s.states[i].q[joint]; }));
  }
  for (int joint = 0; joint < 2; ++joint) {
    columns.push_back(data.variable([joint](const auto& s, std::size_t i) { return s.states[i].dq[joint]; }));
  }
  for (int joint = 0; joint < 2; ++joint) {
    columns.push_back(
        data.variable([joint](const auto& s, std::size_t i) { return s.acceleration[i][joint]; }));
  }
  std::vector<Sequence> sequences;
  for (const diagnose::Block& block : data.blocks()) {
    Sequence sequence;
    sequence.rate_Hz = data.rate_Hz();
    const Eigen::Index steps = block.end - block.first;
    sequence.features.resize(steps, static_cast<Eigen::Index>(columns.size()));
    for (std::size_t i = 0; i < columns.size(); ++i) {
      sequence.features.col(static_cast<Eigen::Index>(i)) = columns[i].segment(block.first, steps);
    }
    sequence.reference.resize(steps, 2);
    for (int joint = 0; joint < 2; ++joint) {
      sequence.reference.col(joint) = residual.segment(joint * data.rows() + block.first, steps);
    }
    sequence.observer = train::Rows::Zero(steps, 2);
    sequence.role.assign(static_cast<std::size_t>(steps), Role::kTest);
    sequences.push_back(std::move(sequence));
  }
  return sequences;
}

}  // namespace

PendulumResult pendulumStudy(const model::ModelDescription& model, const std::string& name,
                             std::span<const diagnose::Recording> training,
                             std::span<const diagnose::Recording> test, const PendulumStudyOptions& options) {
  const diagnose::DatasetOptions dataset{.band_Hz = diagnose::motionBand_Hz(training)};
  std::vector<Sequence> learned = sequencesOf(Dataset(training, dataset), model);
  const std::vector<Sequence> tested = sequencesOf(Dataset(test, dataset), model);
  PendulumResult result{.model = name, .alone = {}, .with_network = {}};
  for (int seed = 1; seed <= options.seeds; ++seed) {
    assignRoles(learned, {.kind = train::SplitKind::kBlocked,
                          .validation_share = options.validation_share,
                          .test_share = 0.0,
                          .block_s = 1.0,
                          .settling_s = 0.0,
                          .seed = static_cast<std::uint64_t>(seed)});
    train::TrainingOptions training_options = options.training;
    training_options.seed = static_cast<std::uint64_t>(seed);
    const auto weights =
        trainNetwork(learned, frameOf(learned, features(), network::OutputKind::kTorque), training_options)
            .weights;
    const train::Score score = scoreOf(weights, tested, Role::kTest);
    result.with_network.push_back(score.network.rms);
    result.alone = score.zero.rms;
  }
  return result;
}

std::string table(std::span<const PendulumResult> results) {
  std::string text = "| rms / N·m, recordings of the test | joint 1 | joint 2 |\n|---|---|---|\n";
  for (const PendulumResult& result : results) {
    text += fmt::format("| {} | {:.3f} | {:.3f} |\n", result.model, result.alone[0], result.alone[1]);
    std::array<std::vector<double>, 2> errors;
    for (const auto& error : result.with_network) {
      errors[0].push_back(error[0]);
      errors[1].push_back(error[1]);
    }
    text +=
        fmt::format("| {} + network | {:.3f} ± {:.3f} | {:.3f} ± {:.3f} |\n", result.model, meanOf(errors[0]),
                    halfInterval(errors[0]), meanOf(errors[1]), halfInterval(errors[1]));
  }
  return text;
}

}  // namespace patella::study
