#include "tools/bench/inference/contender.hpp"

namespace patella::bench {

std::vector<Contender> onnxPeers(const network::NetworkWeights& /*weights*/, bool /*whole*/) {
  return {};
}

}  // namespace patella::bench
