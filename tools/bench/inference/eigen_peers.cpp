#include <algorithm>
#include <array>

#include "tools/bench/inference/contender.hpp"
#include "tools/bench/inference/eigen_peer.hpp"

namespace patella::bench {

namespace {

Contender peer(const char* level, const PeerFunctions& functions, const network::NetworkWeights& w,
               bool whole) {
  const network::LstmWeights& lstm = w.lstm[0];
  const PeerWeights weights{.weight_ih = lstm.weight_ih.data(),
                            .weight_hh = lstm.weight_hh.data(),
                            .bias_ih = lstm.bias_ih.data(),
                            .bias_hh = lstm.bias_hh.data(),
                            .fc_weight = w.fc_weight.data(),
                            .fc_bias = w.fc_bias.data(),
                            .in_proj_weight = w.in_proj_weight.data(),
                            .in_proj_bias = w.in_proj_bias.data(),
                            .out_proj_weight = w.out_proj_weight.data(),
                            .out_proj_bias = w.out_proj_bias.data(),
                            .output_weight = w.output_weight.data(),
                            .output_bias = w.output_bias.data()};
  const std::shared_ptr<void> instance(functions.make(weights), functions.destroy);
  const auto step = whole ? functions.whole : functions.recurrent;
  return {.name = std::string("plain Eigen, ") + level,
          .before = [] {},
          .run =
              [instance, step](std::span<const double> features) {
                std::array<float, kInputs> x{};
                std::transform(features.begin(), features.end(), x.begin(),
                               [](double feature) { return static_cast<float>(feature); });
                return static_cast<double>(step(instance.get(), x.data()));
              }};
}

}  // namespace

std::vector<Contender> eigenPeers(const network::NetworkWeights& weights, bool whole) {
  std::vector<Contender> peers = {peer("baseline", patella_eigen_peer_base, weights, whole)};
#if defined(__x86_64__)
  for (const network::InstructionSet set : network::availableInstructionSets()) {
    if (set == network::InstructionSet::kAvx2 && __builtin_cpu_supports("fma") != 0) {
      peers.push_back(peer("AVX2 and FMA", patella_eigen_peer_v3, weights, whole));
    }
    if (set == network::InstructionSet::kAvx512) {
      peers.push_back(peer("AVX-512", patella_eigen_peer_v4, weights, whole));
    }
  }
#endif
  return peers;
}

}  // namespace patella::bench
