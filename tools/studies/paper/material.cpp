#include "tools/studies/paper/material.hpp"

#include <algorithm>
#include <cmath>

#include "core/estimation/state_smoother.hpp"
#include "tools/train/preparation.hpp"

namespace patella::study {

using train::Role;
using train::Rows;
using train::Sequence;

const Method& targetSmoother() {
  return *std::find_if(methods().begin(), methods().end(),
                       [](const Method& method) { return method.name == "offline smoother, torque"; });
}

Material materialOf(const Recording& recording, std::span<const double> values, double rate_Hz) {
  const model::DynamicsModel model = knownModel(recording.condition);
  std::vector<estimation::ObserverInput> inputs;
  for (const RecordedSample& sample : recording.samples) {
    estimation::ObserverInput input{{}, sample.q, sample.dq, sample.torque_Nm, 1.0 / kRate_Hz};
    input.model = &model;
    input.terms = model.evaluate({.q = input.q, .dq = input.dq, .torque_Nm = input.torque_Nm});
    inputs.push_back(input);
  }
  const auto smooth = smoothUnknownDynamics(targetSmoother().settings(recording.condition, values), inputs);
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
    sequence.reference.row(step) =
        (recording.condition.corrected ? smooth[k].d_Nm : smooth[k].f_u).transpose();
    material.truth.row(step) = sample.truth.transpose();
  }
  return material;
}

network::NetworkWeights paperFrame(const Material& material, const Condition& condition) {
  network::NetworkWeights frame =
      frameOf(std::span(&material.sequence, 1), train::paperFeatures(2),
              condition.corrected ? network::OutputKind::kTorque : network::OutputKind::kAcceleration);
  frame.output_scale.setConstant(frame.output_scale.maxCoeff());
  return frame;
}

std::array<double, 2> meanOverTest(const Rows& difference, const std::vector<Role>& role) {
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

}  // namespace patella::study
