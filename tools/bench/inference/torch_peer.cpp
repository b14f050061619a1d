#include <ATen/Parallel.h>
#include <torch/nn/modules/activation.h>
#include <torch/nn/modules/linear.h>
#include <torch/nn/modules/rnn.h>

#include "tools/bench/inference/contender.hpp"

namespace patella::bench {

namespace {

/// PyTorch's modules as its user would call them step by step: state carried, the last steps kept for
/// attention.
class TorchPeer {
 public:
  explicit TorchPeer(const network::NetworkWeights& weights)
      : lstm_(torch::nn::LSTMOptions(kInputs, kHidden)),
        fc_(kHidden, kChannels),
        attention_(torch::nn::MultiheadAttentionOptions(kChannels, kHeads)),
        output_(kChannels, kOutputs),
        hidden_(torch::zeros({1, 1, kHidden})),
        cell_(torch::zeros({1, 1, kHidden})),
        past_(torch::zeros({kWindow, 1, kChannels})),
        input_(torch::zeros({1, 1, kInputs})) {
    copy(lstm_->named_parameters(), "weight_ih_l0", weights.lstm[0].weight_ih);
    copy(lstm_->named_parameters(), "weight_hh_l0", weights.lstm[0].weight_hh);
    copy(lstm_->named_parameters(), "bias_ih_l0", weights.lstm[0].bias_ih);
    copy(lstm_->named_parameters(), "bias_hh_l0", weights.lstm[0].bias_hh);
    copy(fc_->named_parameters(), "weight", weights.fc_weight);
    copy(fc_->named_parameters(), "bias", weights.fc_bias);
    copy(attention_->named_parameters(), "in_proj_weight", weights.in_proj_weight);
    copy(attention_->named_parameters(), "in_proj_bias", weights.in_proj_bias);
    copy(attention_->named_parameters(), "out_proj.weight", weights.out_proj_weight);
    copy(attention_->named_parameters(), "out_proj.bias", weights.out_proj_bias);
    copy(output_->named_parameters(), "weight", weights.output_weight);
    copy(output_->named_parameters(), "bias", weights.output_bias);
  }

  double recurrent(std::span<const double> features) {
    const torch::InferenceMode inference;
    return signal(features).data_ptr<float>()[0];
  }

  double whole(std::span<const double> features) {
    const torch::InferenceMode inference;
    const torch::Tensor newest = signal(features);
    past_ = torch::cat({past_.slice(0, 1), newest});
    const torch::Tensor context =
        std::get<0>(attention_->forward(newest, past_, past_, /*key_padding_mask=*/{},
                                        /*need_weights=*/false));
    return output_->forward(context).data_ptr<float>()[0];
  }

 private:
  template <typename Parameters, typename Tensor>
  static void copy(Parameters parameters, const char* name, const Tensor& tensor) {
    const torch::NoGradGuard no_gradients;
    std::copy_n(tensor.data(), tensor.size(), parameters[name].template data_ptr<float>());
  }

  torch::Tensor signal(std::span<const double> features) {
    std::transform(features.begin(), features.end(), input_.data_ptr<float>(),
                   [](double feature) { return static_cast<float>(feature); });
    auto [out, state] = lstm_->forward(input_, std::make_tuple(hidden_, cell_));
    std::tie(hidden_, cell_) = state;
    return torch::tanh(fc_->forward(out));
  }

  torch::nn::LSTM lstm_;
  torch::nn::Linear fc_;
  torch::nn::MultiheadAttention attention_;
  torch::nn::Linear output_;
  torch::Tensor hidden_;
  torch::Tensor cell_;
  torch::Tensor past_;
  torch::Tensor input_;
};

}  // namespace

std::vector<Contender> torchPeers(const network::NetworkWeights& weights, bool whole) {
  at::set_num_threads(1);
  const auto peer = std::make_shared<TorchPeer>(weights);
  return {{.name = "libtorch",
           .before = [] {},
           .run =
               [peer, whole](std::span<const double> features) {
                 return whole ? peer->whole(features) : peer->recurrent(features);
               }}};
}

}  // namespace patella::bench
