#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <onnxruntime_c_api.h>

#include "core/network/attention_lstm.hpp"
#include "tools/bench/inference/contender.hpp"
#include "tools/bench/inference/onnx_model.hpp"

namespace patella::bench {

namespace {

const OrtApi& api() {
  static const OrtApi* const table = OrtGetApiBase()->GetApi(ORT_API_VERSION);
  if (table == nullptr) {
    throw std::runtime_error(
        std::string("ONNX Runtime ") + OrtGetApiBase()->GetVersionString() +
        " is older than the header that this program was built with, expected one that knows "
        "version " +
        std::to_string(ORT_API_VERSION) + " of its interface");
  }
  return *table;
}

void require(OrtStatus* status) {
  if (status != nullptr) {
    const std::string text = api().GetErrorMessage(status);
    api().ReleaseStatus(status);
    throw std::runtime_error("ONNX Runtime: " + text);
  }
}

/// A tensor on memory of our own.
class Tensor {
 public:
  Tensor(const OrtMemoryInfo* memory, const std::vector<std::int64_t>& shape) {
    std::size_t count = 1;
    for (const std::int64_t dimension : shape) {
      count *= static_cast<std::size_t>(dimension);
    }
    numbers_.assign(count, 0.0F);
    require(api().CreateTensorWithDataAsOrtValue(memory, numbers_.data(), count * sizeof(float), shape.data(),
                                                 shape.size(), ONNX_TENSOR_ELEMENT_DATA_TYPE_FLOAT, &value_));
  }
  ~Tensor() { api().ReleaseValue(value_); }
  Tensor(const Tensor&) = delete;
  Tensor& operator=(const Tensor&) = delete;

  OrtValue* value() const { return value_; }
  std::vector<float>& numbers() { return numbers_; }

 private:
  std::vector<float> numbers_;
  OrtValue* value_ = nullptr;
};

/// One session on one thread, everything optimised, nothing allocated by the caller in a step. A step writes
/// its state to one of two sets of tensors and reads the other.
class OnnxPeer {
 public:
  OnnxPeer(const network::NetworkWeights& weights, OnnxForm form) {
    OrtSessionOptions* options = nullptr;
    require(api().CreateEnv(ORT_LOGGING_LEVEL_ERROR, "patella", &environment_));
    require(api().CreateSessionOptions(&options));
    require(api().SetIntraOpNumThreads(options, 1));
    require(api().SetInterOpNumThreads(options, 1));
    require(api().SetSessionGraphOptimizationLevel(options, ORT_ENABLE_ALL));
    const std::string model = onnxModel(weights, form);
    require(api().CreateSessionFromArray(environment_, model.data(), model.size(), options, &session_));
    api().ReleaseSessionOptions(options);
    require(api().CreateCpuMemoryInfo(OrtArenaAllocator, OrtMemTypeDefault, &memory_));
    features_ = std::make_unique<Tensor>(memory_, Shape{1, 1, kInputs});
    result_ =
        std::make_unique<Tensor>(memory_, Shape{1, form == OnnxForm::kRecurrent ? kChannels : kOutputs});
    constexpr std::int64_t kWidth = kChannels / kHeads;
    std::vector<Shape> states = {{1, 1, kHidden}, {1, 1, kHidden}};
    if (form == OnnxForm::kKept) {
      states.push_back({kHeads, kWidth, weights.window});
      states.push_back({kHeads, weights.window, kWidth});
    } else if (form == OnnxForm::kAnew) {
      states.push_back({weights.window, kChannels});
      input_names_[3] = "past";
      output_names_[3] = "next_past";
    }
    for (auto& side : states_) {
      for (const Shape& shape : states) {
        side.push_back(std::make_unique<Tensor>(memory_, shape));
      }
    }
  }
  ~OnnxPeer() {
    api().ReleaseMemoryInfo(memory_);
    api().ReleaseSession(session_);
    api().ReleaseEnv(environment_);
  }
  OnnxPeer(const OnnxPeer&) = delete;
  OnnxPeer& operator=(const OnnxPeer&) = delete;

  const std::vector<float>& step(std::span<const double> features) {
    std::transform(features.begin(), features.end(), features_->numbers().begin(),
                   [](double feature) { return static_cast<float>(feature); });
    std::array<const OrtValue*, 5> inputs = {features_->value()};
    std::array<OrtValue*, 5> outputs = {result_->value()};
    const std::size_t states = states_[0].size();
    for (std::size_t i = 0; i < states; ++i) {
      inputs[1 + i] = states_[newest_][i]->value();
      outputs[1 + i] = states_[1 - newest_][i]->value();
    }
    require(api().Run(session_, nullptr, input_names_.data(), inputs.data(), 1 + states, output_names_.data(),
                      1 + states, outputs.data()));
    newest_ = 1 - newest_;
    return result_->numbers();
  }

 private:
  using Shape = std::vector<std::int64_t>;

  std::array<const char*, 5> input_names_ = {"features", "hidden", "cell", "keys", "values"};
  std::array<const char*, 5> output_names_ = {"result", "next_hidden", "next_cell", "next_keys",
                                              "next_values"};
  OrtEnv* environment_ = nullptr;
  OrtSession* session_ = nullptr;
  OrtMemoryInfo* memory_ = nullptr;
  std::unique_ptr<Tensor> features_;
  std::unique_ptr<Tensor> result_;
  std::array<std::vector<std::unique_ptr<Tensor>>, 2> states_;
  std::size_t newest_ = 0;
};

/// A peer that says something else is no peer. Only once W steps have passed: before, its past is zeros.
void requireSameNumbers(const network::NetworkWeights& weights, OnnxForm form) {
  constexpr double kTolerance = 1e-4;
  OnnxPeer peer(weights, form);
  network::AttentionLstm own(weights);
  for (int step = 0; step < 2 * weights.window; ++step) {
    std::array<double, kInputs> features{};
    for (std::size_t i = 0; i < features.size(); ++i) {
      features[i] = std::sin(0.1 * (1.0 + static_cast<double>(i)) * step);
    }
    const float theirs = peer.step(features)[0];
    const double ours = own.step(features)[0];
    own.prepare();
    if (step >= weights.window && !(std::abs(theirs - ours) < kTolerance)) {
      throw std::runtime_error("ONNX Runtime gives " + std::to_string(theirs) + " where this network gives " +
                               std::to_string(ours));
    }
  }
}

}  // namespace

std::vector<Contender> onnxPeers(const network::NetworkWeights& weights, bool whole) {
  const std::string name = std::string("ONNX Runtime ") + OrtGetApiBase()->GetVersionString();
  const auto contender = [&](OnnxForm form, const std::string& suffix) -> Contender {
    const auto peer = std::make_shared<OnnxPeer>(weights, form);
    return {.name = name + suffix,
            .before = [] {},
            .run = [peer](std::span<const double> features) { return peer->step(features)[0]; }};
  };
  if (!whole) {
    return {contender(OnnxForm::kRecurrent, "")};
  }
  requireSameNumbers(weights, OnnxForm::kKept);
  requireSameNumbers(weights, OnnxForm::kAnew);
  return {contender(OnnxForm::kKept, ", keys kept"), contender(OnnxForm::kAnew, ", keys anew")};
}

}  // namespace patella::bench
