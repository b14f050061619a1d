#include <cmath>
#include <cstdint>
#include <utility>

#include "core/network/attention_lstm.hpp"
#include "tools/bench/inference/contender.hpp"

namespace patella::bench {

namespace {

/// The network's first part, put together from the classes it is made of.
struct RecurrentPart {
  explicit RecurrentPart(const network::NetworkWeights& weights)
      : functions(network::kernel::functionsFor({})),
        input(kInputs, network::Precision::kFloat32),
        lstm(weights.lstm[0], network::Precision::kFloat32, network::Precision::kFloat32),
        dense(weights.fc_weight.cast<double>(), network::Precision::kFloat32),
        bias(kChannels),
        output(kChannels) {
    std::copy_n(weights.fc_bias.data(), kChannels, bias.data());
  }

  double step(std::span<const double> features) noexcept {
    std::transform(features.begin(), features.end(), input.data(),
                   [](double feature) { return static_cast<float>(feature); });
    lstm.step(functions, input, false);
    dense.productTanh(functions, lstm.hidden(), bias.data(), output.data());
    return static_cast<double>(output.data()[0]);
  }

  const network::kernel::Functions& functions;
  network::Signal input;
  network::LstmLayer lstm;
  network::LinearMap dense;
  network::AlignedFloats bias;
  network::AlignedFloats output;
};

}  // namespace

std::size_t bytesOfRecurrentPart() {
  constexpr std::size_t kGates = 4 * kHidden;
  constexpr std::size_t kFloats = kGates * (kInputs + kHidden + 1) + kChannels * (kHidden + 1);
  return kFloats * sizeof(float);
}

std::size_t bytesOfStep() {
  constexpr std::size_t kProjected = 2 * kChannels + kHeads * kOutputs;
  constexpr std::size_t kFloats =
      kProjected * (kChannels + 1) + static_cast<std::size_t>(kWindow) * (kChannels + kHeads * kOutputs);
  return bytesOfRecurrentPart() + kFloats * sizeof(float);
}

Contender ownNetwork(const std::string& name, const network::NetworkWeights& weights,
                     const network::InferenceOptions& options, bool two_phase) {
  const auto own = std::make_shared<network::AttentionLstm>(weights, options);
  return {.name = name,
          .before =
              [own, two_phase] {
                if (two_phase) {
                  own->prepare();
                }
              },
          .run = [own](std::span<const double> features) { return own->step(features)[0]; }};
}

Contender ownRecurrentPart(const network::NetworkWeights& weights) {
  const auto part = std::make_shared<RecurrentPart>(weights);
  return {.name = "Patella",
          .before = [] {},
          .run = [part](std::span<const double> features) { return part->step(features); }};
}

}  // namespace patella::bench
