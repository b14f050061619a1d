#include "tools/bench/learning/paper_study.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/estimation/state_smoother.hpp"
#include "tools/bench/observers/evaluation.hpp"
#include "tools/train/preparation.hpp"
#include "tools/train/score.hpp"

namespace patella::bench {
namespace {

using train::Role;
using train::Rows;
using train::Sequence;

constexpr std::uint64_t kTuningSeed = 101;
constexpr std::uint64_t kUnseen = 1000;

const Method& smoother() {
  const auto found = std::find_if(methods().begin(), methods().end(), [](const Method& method) {
    return method.name == "offline smoother, torque";
  });
  return *found;
}

/// A recording with the smoothed target as `reference` and the truth beside it.
struct Material {
  Sequence sequence;
  Rows truth;
};

Material materialOf(const Recording& recording, std::span<const double> values, double rate_Hz) {
  const model::DynamicsModel model = knownModel(recording.condition.noise);
  std::vector<estimation::ObserverInput> inputs;
  for (const RecordedSample& sample : recording.samples) {
    estimation::ObserverInput input{{}, sample.q, sample.dq, sample.torque_Nm, 1.0 / kRate_Hz};
    input.model = &model;
    input.terms = model.evaluate({.q = input.q, .dq = input.dq, .torque_Nm = input.torque_Nm});
    inputs.push_back(input);
  }
  const auto smooth = smoothUnknownDynamics(smoother().settings(recording.condition, values), inputs);
  const auto stride = static_cast<std::size_t>(std::lround(kRate_Hz / rate_Hz));
  const auto steps = static_cast<Eigen::Index>((recording.samples.size() - 1) / stride + 1);
  Material material;
  Sequence& sequence = material.sequence;
  sequence.rate_Hz = rate_Hz;
  sequence.features.resize(steps, 5);
  for (Rows* rows : {&sequence.reference, &sequence.observer, &material.truth}) {
    rows->setZero(steps, 2);
  }
  sequence.role.assign(static_cast<std::size_t>(steps), Role::kIgnored);
  for (Eigen::Index step = 0; step < steps; ++step) {
    const std::size_t k = static_cast<std::size_t>(step) * stride;
    const RecordedSample& sample = recording.samples[k];
    sequence.features.row(step) << sample.q.transpose(), sample.dq.transpose(),
        static_cast<double>(k) / kRate_Hz;
    sequence.reference.row(step) = smooth[k].f_u.transpose();
    material.truth.row(step) = sample.truth.transpose();
  }
  return material;
}

std::array<double, 2> meanAbsolute(const Rows& difference, const std::vector<Role>& role) {
  std::array<double, 2> sum{};
  double count = 0.0;
  for (Eigen::Index step = 0; step < difference.rows(); ++step) {
    if (role[static_cast<std::size_t>(step)] == Role::kTest) {
      sum[0] += std::abs(difference(step, 0));
      sum[1] += std::abs(difference(step, 1));
      count += 1.0;
    }
  }
  return {sum[0] / count, sum[1] / count};
}

PaperResult resultOf(Experiment experiment, const std::string& tested_on, std::uint64_t seed,
                     const Material& material, const network::NetworkWeights& weights) {
  const std::vector<Role>& role = material.sequence.role;
  return {.experiment = experiment,
          .tested_on = tested_on,
          .seed = seed,
          .network = meanAbsolute(deliveredOf(weights, material.sequence) - material.truth, role),
          .smoother = meanAbsolute(material.sequence.reference - material.truth, role),
          .zero = meanAbsolute(material.truth, role)};
}

}  // namespace

std::vector<PaperResult> paperStudy(const PaperStudyOptions& options,
                                    const std::function<void(const PaperResult&)>& done) {
  std::vector<PaperResult> results;
  const auto add = [&](const PaperResult& result) {
    results.push_back(result);
    if (done) {
      done(result);
    }
  };
  for (const Experiment experiment : options.experiments) {
    const Condition condition{.experiment = experiment, .noise = Noise::kVelocity};
    const std::vector<Recording> tuning{record(condition, options.seconds, kTuningSeed)};
    const std::vector<double> values = tune(smoother(), tuning);
    for (int i = 1; i <= options.seeds; ++i) {
      const auto seed = static_cast<std::uint64_t>(i);
      Material material = materialOf(record(condition, options.seconds, seed), values, options.rate_Hz);
      for (const train::SplitKind split : options.splits) {
        const bool validates = options.training.stopping == train::Stopping::kValidation;
        assignRoles(std::span(&material.sequence, 1), {.kind = split,
                                                       .validation_share = validates ? 0.15 : 0.0,
                                                       .gap_s = options.training.window / options.rate_Hz,
                                                       .seed = seed});
        const auto frame = frameOf(std::span(&material.sequence, 1), train::paperFeatures(2),
                                   network::OutputKind::kAcceleration);
        train::TrainingOptions training = options.training;
        training.seed = seed;
        const auto weights = trainNetwork(std::span(&material.sequence, 1), frame, training).weights;
        add(resultOf(experiment, train::splitNames()[static_cast<std::size_t>(split)], seed, material,
                     weights));
        if (split == train::SplitKind::kRandom) {
          Material unseen =
              materialOf(record(condition, options.seconds, kUnseen + seed), values, options.rate_Hz);
          assignRole(unseen.sequence, Role::kTest, kSettling_s);
          add(resultOf(experiment, "unseen trajectory", seed, unseen, weights));
        }
      }
    }
  }
  return results;
}

}  // namespace patella::bench
