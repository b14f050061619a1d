// A weights file is read or refused, with an error that names what is wrong.
#include <cmath>
#include <stdexcept>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "firmware_app/weights/safetensors_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace patella;
  const fuzz::MemoryFile file(fuzz::text(data, size));
  try {
    const app::Safetensors content = app::readSafetensors(file.path());
    for (const auto& [name, tensor] : content.tensors) {
      for (const float value : tensor.values) {
        fuzz::require(std::isfinite(value), "every weight that was read is finite");
      }
    }
    app::loadNetworkWeights(file.path());
  } catch (const app::FileError&) {
    // refused
  }
  return 0;
}
