#include "tests/unit/train/made_up.hpp"

#include <cmath>

#include "sim/random.hpp"
#include "tools/train/split.hpp"

namespace patella::train {

std::vector<Sequence> madeUpSequences(int count, Eigen::Index steps) {
  std::vector<Sequence> sequences;
  for (int n = 0; n < count; ++n) {
    sim::Random random(static_cast<std::uint64_t>(n), 7);
    Sequence sequence;
    sequence.name = "run_" + std::to_string(n) + ".csv";
    sequence.sha256 = "hash of " + sequence.name;
    sequence.rate_Hz = 100.0;
    sequence.features.resize(steps, 2);
    sequence.reference.resize(steps, 1);
    sequence.role.assign(static_cast<std::size_t>(steps), Role::kIgnored);
    double mean = 0.0;
    for (Eigen::Index k = 0; k < steps; ++k) {
      const double t = 0.1 * static_cast<double>(k) + n;
      sequence.features.row(k) << 5.0 + std::sin(t) + 0.3 * random.gaussian(), 0.1 * std::cos(0.37 * t);
      mean += 0.3 * (sequence.features(k, 0) - 5.0 - mean);
      sequence.reference(k, 0) = std::tanh(2.0 * mean) + 10.0 * sequence.features(k, 1);
    }
    sequence.observer = 0.8 * sequence.reference;
    sequences.push_back(std::move(sequence));
  }
  assignRoles(sequences, {.kind = SplitKind::kRecording, .settling_s = 0.1});
  return sequences;
}

network::NetworkWeights madeUpFrame(const std::vector<Sequence>& sequences, network::OutputKind output) {
  return frameOf(sequences, {"q1_rad", "dq1_rad_s"}, output);
}

TrainingOptions smallTraining() {
  return {.hidden = 12,
          .channels = 8,
          .heads = 2,
          .window = 9,
          .epochs = 8,
          .batch = 8,
          .sequence_steps = 48,
          .burn_in = 12,
          .learning_rate = 1e-2};
}

}  // namespace patella::train
