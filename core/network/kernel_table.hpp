// The kernel's functions for one instruction set, and the tables behind functionsFor().
#pragma once

#include "core/network/kernel_attention.hpp"
#include "core/network/kernel_layers.hpp"

namespace patella::network::kernel {

template <typename Isa>
constexpr Functions functionsOf() noexcept {
  using Layers = KernelLayers<Isa>;
  return {.product = Layers::template product<FloatTerm>,
          .product_int16 = Layers::template product<Int16Term>,
          .tanh_of = Layers::template tanhOfSum<FloatTerm>,
          .tanh_of_int16 = Layers::template tanhOfSum<Int16Term>,
          .tanh_of_both = Layers::template tanhOfSum<FloatTerm, FloatTerm>,
          .tanh_of_both_mixed = Layers::template tanhOfSum<Int16Term, FloatTerm>,
          .tanh_of_both_int16 = Layers::template tanhOfSum<Int16Term, Int16Term>,
          .quantise = Layers::quantise,
          .lstm_cell = Layers::lstmCell,
          .attend = KernelAttention<Isa>::attend};
}

extern const Functions kBaselineFunctions;
extern const Functions kAvx2Functions;    ///< x86-64 only
extern const Functions kAvx512Functions;  ///< x86-64 only

}  // namespace patella::network::kernel
