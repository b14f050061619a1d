// Adam with decoupled weight decay, its state in plain tensors that a checkpoint can hold.
#pragma once

#include <cmath>
#include <cstdint>

#include <torch/torch.h>

#include "tools/train/torch_network.hpp"

namespace patella::train {

/// Kingma and Ba (2015), Algorithm 1; decay after Loshchilov and Hutter (2019).
class Adam {
 public:
  explicit Adam(const NamedTensors& parameters) {
    for (const auto& [name, tensor] : parameters) {
      mean.emplace_back(name, torch::zeros_like(tensor));
      square.emplace_back(name, torch::zeros_like(tensor));
    }
  }

  /// Moves the parameters that want gradients against them, which are first scaled down to a joint norm of
  /// one at most.
  void step(NamedTensors& parameters, double rate, double decay) {
    const torch::NoGradGuard no_gradients;
    constexpr double kMean = 0.9;
    constexpr double kSquare = 0.999;
    constexpr double kSmall = 1e-8;
    double norm = 0.0;
    for (const auto& [name, tensor] : parameters) {
      norm += !tensor.requires_grad() ? 0.0 : tensor.grad().square().sum().item<double>();
    }
    const double shrink = 1.0 / std::max(1.0, std::sqrt(norm));
    ++steps;
    const double mean_share = 1.0 - std::pow(kMean, static_cast<double>(steps));
    const double square_share = 1.0 - std::pow(kSquare, static_cast<double>(steps));
    for (std::size_t i = 0; i < parameters.size(); ++i) {
      torch::Tensor& tensor = parameters[i].second;
      if (!tensor.requires_grad()) {
        continue;
      }
      const torch::Tensor gradient = shrink * tensor.grad();
      mean[i].second.mul_(kMean).add_(gradient, 1.0 - kMean);
      square[i].second.mul_(kSquare).addcmul_(gradient, gradient, 1.0 - kSquare);
      tensor.mul_(1.0 - rate * decay);
      tensor.addcdiv_(mean[i].second, (square[i].second / square_share).sqrt_().add_(kSmall),
                      -rate / mean_share);
      tensor.mutable_grad().reset();
    }
  }

  std::int64_t steps = 0;
  NamedTensors mean;
  NamedTensors square;
};

}  // namespace patella::train
