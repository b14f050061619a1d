// The kernel's functions for one instruction set, and the tables behind functionsFor().
#pragma once

#include "core/network/kernel_attention.hpp"
#include "core/network/kernel_layers.hpp"

namespace patella::network::kernel {

template <typename Isa>
constexpr Functions functionsOf() noexcept {
  using Layers = KernelLayers<Isa>;
  return {.product = Layers::template product<false>,
          .product_tanh = Layers::template product<true>,
          .product_int16 = Layers::template productInt16<false>,
          .product_tanh_int16 = Layers::template productInt16<true>,
          .quantise = Layers::quantise,
          .lstm_cell = Layers::lstmCell,
          .attend = KernelAttention<Isa>::attend};
}

extern const Functions kBaselineFunctions;
extern const Functions kAvx2Functions;    ///< x86-64 only
extern const Functions kAvx512Functions;  ///< x86-64 only

}  // namespace patella::network::kernel
