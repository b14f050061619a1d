// Sealed weights with flipped bits are refused: three bytes a flip, place and bit. Only flips that destroy
// both keys of the seal may pass, and then the weights are known to have none.
#include <string>

#include "core/network/network_weights.hpp"
#include "drivers/files/temporary_folder.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"

namespace {

using namespace patella;

network::NetworkWeights tinyNetwork() {
  network::NetworkWeights weights;
  weights.lstm.resize(1);
  weights.heads = 1;
  weights.window = 4;
  weights.features = {"q1_rad"};
  weights.feature_mean = weights.output_mean = Eigen::VectorXd::Zero(1);
  weights.feature_scale = weights.output_scale = Eigen::VectorXd::Ones(1);
  visitTensors(weights, {.inputs = 1, .hidden = 2, .layers = 1, .channels = 2, .outputs = 1},
               [](const std::string&, auto& tensor, Eigen::Index rows, Eigen::Index cols) {
                 tensor = std::decay_t<decltype(tensor)>::Constant(rows, cols, 0.25F);
               });
  return weights;
}

std::string sealedBytes() {
  const files::TemporaryFolder folder;
  const std::filesystem::path path = folder / "sealed.safetensors";
  app::saveNetworkWeights(path, tinyNetwork());
  return app::readFile(path);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string whole = sealedBytes();
  std::string damaged = whole;
  for (std::size_t at = 0; at + 3 <= size; at += 3) {
    const std::size_t place = (data[at] * 256U + data[at + 1]) % damaged.size();
    damaged[place] = static_cast<char>(damaged[place] ^ (1 << (data[at + 2] & 7U)));
  }
  const fuzz::MemoryFile file(damaged);
  app::WeightsOrigin origin;
  bool loaded = true;
  try {
    app::loadNetworkWeights(file.path(), &origin);
  } catch (const app::FileError&) {
    loaded = false;
  }
  const bool keys_gone =
      damaged.find("\"seal\"") == std::string::npos && damaged.find("\"seal_sha256\"") == std::string::npos;
  if (damaged == whole)
    fuzz::require(loaded && origin.sealed, "what is not damaged is loaded");
  else
    fuzz::require(!loaded || (!origin.sealed && keys_gone),
                  "what is damaged is refused, or known to have no seal");
  return 0;
}
