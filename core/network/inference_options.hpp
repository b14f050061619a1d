// How the network is computed: which of the kernel's variants, and with which numbers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/network/kernel.hpp"

namespace patella::network {

/// Variants of the kernel. All give the same bits; they differ in speed.
enum class InstructionSet {
  kBaseline,  ///< SSE2 on x86-64, NEON on aarch64
  kAvx2,
  kAvx512  ///< F, BW, DQ and VL
};

/// "baseline", "avx2", "avx512".
std::string nameOf(InstructionSet set);

/// Instruction sets of this processor, narrowest first; never empty.
std::vector<InstructionSet> availableInstructionSets();

enum class Precision {
  kFloat32,
  kInt16  ///< weights and activations, summed in 32 bits; the first layer's inputs and the attention in
          ///< float32
};

struct InferenceOptions {
  std::optional<InstructionSet> instruction_set{};  ///< none: the widest this processor has
  Precision precision = Precision::kFloat32;
  /// Largest difference of int16 from float32 outputs, in units of the network's output_scale.
  double int16_tolerance = 2e-3;
};

namespace kernel {
/// Throws std::invalid_argument naming the set, and those there are, where the processor lacks it.
const Functions& functionsFor(std::optional<InstructionSet> set);
}  // namespace kernel

}  // namespace patella::network
