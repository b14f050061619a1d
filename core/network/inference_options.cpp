#include "core/network/inference_options.hpp"

#include <stdexcept>

#include "core/network/kernel_table.hpp"

namespace patella::network {

namespace {

bool isAvailable(InstructionSet set) {
#if defined(__x86_64__)
  switch (set) {
    case InstructionSet::kBaseline:
      return true;
    case InstructionSet::kAvx2:
      return __builtin_cpu_supports("avx2") != 0;
    case InstructionSet::kAvx512:
      return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
             __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
  }
  return false;
#else
  return set == InstructionSet::kBaseline;
#endif
}

}  // namespace

std::string nameOf(InstructionSet set) {
  return set == InstructionSet::kAvx512 ? "avx512" : set == InstructionSet::kAvx2 ? "avx2" : "baseline";
}

std::vector<InstructionSet> availableInstructionSets() {
  std::vector<InstructionSet> sets;
  for (const InstructionSet set : {InstructionSet::kBaseline, InstructionSet::kAvx2, InstructionSet::kAvx512})
    if (isAvailable(set))
      sets.push_back(set);
  return sets;
}

namespace kernel {

const Functions& functionsFor(std::optional<InstructionSet> wanted) {
  const InstructionSet set = wanted.value_or(availableInstructionSets().back());
  if (!isAvailable(set)) {
    std::string message = "instruction set '" + nameOf(set) + "', expected one that this processor has:";
    for (const InstructionSet available : availableInstructionSets())
      message += " " + nameOf(available);
    throw std::invalid_argument(message);
  }
#if defined(__x86_64__)
  if (set == InstructionSet::kAvx512)
    return kAvx512Functions;
  if (set == InstructionSet::kAvx2)
    return kAvx2Functions;
#endif
  return kBaselineFunctions;
}

}  // namespace kernel

}  // namespace patella::network
