// patella-bench-inference: what a step of the network costs, and what it costs others.
#include <cstdio>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/network/attention_lstm.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "tools/bench/inference/measurement.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"

namespace {

using namespace patella;
using namespace patella::bench;

constexpr std::size_t kBuffers =
    4;  ///< of the plain read; where memory lies decides how well it fits the cache

/// Contenders, and where in the list those are that the targets compare.
struct Field {
  std::vector<Contender> contenders;
  std::vector<std::size_t> read, read_recurrent;
  std::size_t own = 0, own_two_phase = 0, own_int16 = 0, own_int16_two_phase = 0, own_recurrent = 0;
  std::vector<std::size_t> eigen, eigen_recurrent, torch, torch_recurrent, onnx, onnx_recurrent;

  std::size_t add(Contender contender) {
    contenders.push_back(std::move(contender));
    return contenders.size() - 1;
  }
  std::vector<std::size_t> addAll(std::vector<Contender> peers, const std::string& suffix) {
    std::vector<std::size_t> indices;
    for (Contender& peer : peers) {
      peer.name += suffix;
      indices.push_back(add(std::move(peer)));
    }
    return indices;
  }
};

// The path has ten lags, as patella-train gives it.
network::NetworkWeights withLinearPath(network::NetworkWeights weights) {
  weights.linear_lags = {0, 1, 2, 3, 5, 8, 12, 18, 26, 36};
  weights.linear_weight = network::WeightMatrix::Constant(kOutputs, 10 * kInputs, 0.1F);
  weights.linear_bound = network::WeightVector::Constant(kOutputs, 10.0F);
  return weights;
}

Field makeField(const network::NetworkWeights& weights) {
  const network::InferenceOptions float32;
  const network::InferenceOptions int16{.precision = network::Precision::kInt16};
  Field field;
  for (std::size_t i = 0; i < kBuffers; ++i) {
    field.read.push_back(field.add(readOfBytes(bytesOfStep())));
    field.read_recurrent.push_back(field.add(readOfBytes(bytesOfRecurrentPart())));
    field.contenders.back().name += ": LSTM, dense";
  }
  field.own = field.add(ownNetwork("Patella float32, one phase", weights, float32, false));
  field.own_two_phase = field.add(ownNetwork("Patella float32, tick to output", weights, float32, true));
  field.own_int16 = field.add(ownNetwork("Patella int16, one phase", weights, int16, false));
  field.own_int16_two_phase = field.add(ownNetwork("Patella int16, tick to output", weights, int16, true));
  for (const network::InstructionSet set : network::availableInstructionSets()) {
    for (const network::Precision precision : {network::Precision::kFloat32, network::Precision::kInt16}) {
      const std::string number = precision == network::Precision::kInt16 ? "int16" : "float32";
      field.add(ownNetwork("  " + number + ", one phase, " + nameOf(set), weights,
                           {.instruction_set = set, .precision = precision}, false));
    }
  }
  const network::NetworkWeights linear = withLinearPath(weights);
  field.add(ownNetwork("  float32, one phase, linear path", linear, float32, false));
  field.add(ownNetwork("  float32, tick to output, linear path", linear, float32, true));
  field.eigen = field.addAll(eigenPeers(weights, true), "");
  field.torch = field.addAll(torchPeers(weights, true), "");
  field.onnx = field.addAll(onnxPeers(weights, true), "");
  Contender recurrent = ownRecurrentPart(weights);
  recurrent.name += ": LSTM, dense, tanh";
  field.own_recurrent = field.add(std::move(recurrent));
  field.eigen_recurrent = field.addAll(eigenPeers(weights, false), ": LSTM, dense, tanh");
  field.torch_recurrent = field.addAll(torchPeers(weights, false), ": LSTM, dense, tanh");
  field.onnx_recurrent = field.addAll(onnxPeers(weights, false), ": LSTM, dense, tanh");
  return field;
}

void printTable(const Field& field, const std::vector<std::vector<Timing>>& timings) {
  std::printf("%-42s %26s %26s %26s\n", "", "hot", "after 1 ms idle", "caches evicted");
  std::printf("%-42s", "µs a step");
  for (std::size_t i = 0; i < timings.size(); ++i) {
    std::printf(" %8s %8s %8s", "median", "p99", "max");
  }
  std::printf("\n");
  for (std::size_t i = 0; i < field.contenders.size(); ++i) {
    std::printf("%-42s", field.contenders[i].name.c_str());
    for (const std::vector<Timing>& condition : timings) {
      for (const double quantile : {0.5, 0.99, 1.0}) {
        std::printf(" %8.2f", 1e-3 * quantileOf(condition[i].steps_ns, quantile));
      }
    }
    std::printf("\n");
  }
}

/// The fastest of several by its median: the strictest to be compared with.
const Timing& fastest(const std::vector<Timing>& timings, const std::vector<std::size_t>& indices) {
  std::size_t best = indices.front();
  for (const std::size_t index : indices) {
    if (quantileOf(timings[index].steps_ns, 0.5) < quantileOf(timings[best].steps_ns, 0.5)) {
      best = index;
    }
  }
  return timings[best];
}

void printTarget(const char* what, double ratio, bool at_most, double target) {
  const bool met = at_most ? ratio <= target : ratio >= target;
  std::printf("  %-62s %7.2f   %s %g: %s\n", what, ratio, at_most ? "at most " : "at least", target,
              met ? "met" : "NOT met");
}

void printRatio(const char* what, double ratio) {
  std::printf("  %-62s %7.2f\n", what, ratio);
}

void printRatios(const Field& field, const std::vector<Timing>& hot) {
  const Timing& read = fastest(hot, field.read);
  const double bytes = static_cast<double>(bytesOfStep());
  std::printf("\nOne step reads %.0f KB; the fastest plain read of as many took %.2f µs: %.0f GB/s\n",
              bytes / 1024.0, 1e-3 * quantileOf(read.steps_ns, 0.5), bytes / quantileOf(read.steps_ns, 0.5));
  std::printf("\nRatios, hot: median over rounds of the medians in a round\n");
  printTarget("float32 to the read of its bytes", ratioOf(hot[field.own], read), true, 1.2);
  printTarget("float32, tick to output to one phase", ratioOf(hot[field.own_two_phase], hot[field.own]), true,
              0.5);
  printTarget("plain Eigen, best, to float32: LSTM, dense, tanh",
              ratioOf(fastest(hot, field.eigen_recurrent), hot[field.own_recurrent]), false, 1.1);
  printTarget("plain Eigen, best, to float32: whole", ratioOf(fastest(hot, field.eigen), hot[field.own]),
              false, 1.8);
  std::printf("  What those two could be at most, were nothing done but the reading of the bytes:\n");
  printRatio("  LSTM, dense, tanh",
             ratioOf(fastest(hot, field.eigen_recurrent), fastest(hot, field.read_recurrent)));
  printRatio("  whole", ratioOf(fastest(hot, field.eigen), read));
  if (field.torch.empty()) {
    std::printf("  SKIPPED: libtorch, which this build did not find (package libtorch-dev)\n");
  } else {
    printTarget("libtorch to float32: LSTM, dense, tanh",
                ratioOf(hot[field.torch_recurrent.front()], hot[field.own_recurrent]), false, 10.0);
    printTarget("libtorch to float32: whole", ratioOf(hot[field.torch.front()], hot[field.own]), false, 30.0);
  }
  if (field.onnx.empty()) {
    std::printf("  SKIPPED: ONNX Runtime, which this build did not find (PATELLA_ONNXRUNTIME_DIR)\n");
  } else {
    printRatio("ONNX Runtime to float32: LSTM, dense, tanh",
               ratioOf(hot[field.onnx_recurrent.front()], hot[field.own_recurrent]));
    printTarget("ONNX Runtime, keys and values kept, to float32: whole",
                ratioOf(hot[field.onnx.front()], hot[field.own]), false, 9.0);
    printTarget("ONNX Runtime, all of them anew in a step, to float32: whole",
                ratioOf(hot[field.onnx.back()], hot[field.own]), false, 9.0);
  }
  printTarget("float32 to int16", ratioOf(hot[field.own], hot[field.own_int16]), false, 1.4);
  printRatio("int16, tick to output to one phase",
             ratioOf(hot[field.own_int16_two_phase], hot[field.own_int16]));
  printRatio("plain Eigen, baseline, to float32: whole", ratioOf(hot[field.eigen.front()], hot[field.own]));
  printRatio("plain Eigen, best, to float32, tick to output",
             ratioOf(fastest(hot, field.eigen), hot[field.own_two_phase]));
}

void run(const MeasurementOptions& options) {
  const network::NetworkWeights weights = randomWeights();
  std::printf(
      "%d features, LSTM %d, dense %d, %d heads, W = %d, %d outputs; int16 differs by %.1e of output_scale\n",
      kInputs, kHidden, kChannels, kHeads, kWindow, kOutputs, network::AttentionLstm::int16Error(weights));
  Field field = makeField(weights);
  MeasurementOptions evicted = options;
  evicted.rounds = options.rounds / 8 + 1;
  const std::vector<std::vector<Timing>> timings = {measure(field.contenders, Condition::kHot, options),
                                                    measure(field.contenders, Condition::kIdle, options),
                                                    measure(field.contenders, Condition::kEvicted, evicted)};
  printTable(field, timings);
  printRatios(field, timings[0]);
}

// The cost of 16 bits for trained networks: by how much the outputs may differ.
void printInt16Errors(const std::vector<std::string>& files) {
  std::printf(
      "largest difference of int16 from float32, in units of output_scale, on sines and noise once and "
      "three\n"
      "times as wide as feature_scale:\n");
  for (const std::string& file : files) {
    const network::NetworkWeights weights = app::loadNetworkWeights(file);
    std::printf("  %-60s %.1e\n", file.c_str(), network::AttentionLstm::int16Error(weights));
  }
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app("Times a step of the network against the memory it reads and against peers, taking turns.",
               "patella-bench-inference");
  MeasurementOptions options;
  std::vector<std::string> weights;
  app.add_option("--weights", weights, "trained networks: prints what 16 bits cost each, and times nothing")
      ->check(CLI::ExistingFile);
  app.add_option("--rounds", options.rounds, "turns of every contender")
      ->check(patella::options::wholeNumberFrom(1, 100000))
      ->capture_default_str();
  app.add_option("--hot-steps", options.hot_steps, "timed steps in a hot turn")
      ->check(patella::options::wholeNumberFrom(1, 10000))
      ->capture_default_str();
  app.add_option("--eviction-MB", options.eviction_MB, "memory written to empty the caches")
      ->check(patella::options::wholeNumberFrom(1, 4096))
      ->capture_default_str();
  return patella::options::runProgram(app, argc, argv, [&] {
    if (weights.empty()) {
      run(options);
    } else {
      printInt16Errors(weights);
    }
  });
}
