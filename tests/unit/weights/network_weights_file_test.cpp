// Networks survive the way through a file, and files that do not describe one are refused by name.
#include "firmware_app/weights/network_weights_file.hpp"

#include <functional>
#include <stdexcept>

#include <doctest/doctest.h>

#include "core/network/attention_lstm.hpp"
#include "firmware_app/weights/safetensors_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/network/random_network.hpp"

namespace patella::app {

using test::ScratchFolder;

namespace {

network::NetworkWeights sample(int layers, std::vector<int> lags = {}) {
  network::RandomNetworkOptions options;
  options.shape.layers = layers;
  options.linear_lags = std::move(lags);
  network::NetworkWeights weights = network::randomNetwork(options);
  weights.features = {"q1_rad", "q2_rad", "dq1_rad_s", "dq2_rad_s", "observer1_Nm"};
  weights.window = 48;
  weights.rate_Hz = 500.0;
  weights.attention_scale = network::AttentionScale::kNone;
  weights.output = network::OutputKind::kTorqueCorrection;
  return weights;
}

/// The loader's message for a sound file after `spoil`; its path is replaced by "file".
std::string refusal(const std::function<void(Safetensors&)>& spoil, const std::vector<int>& lags = {}) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "net.safetensors";
  saveNetworkWeights(path, sample(1, lags));
  Safetensors content = readSafetensors(path);
  spoil(content);
  writeSafetensors(path, content);
  try {
    loadNetworkWeights(path);
    return "accepted";
  } catch (const std::runtime_error& error) {
    const std::string message = error.what();
    const std::string prefix = path.string() + ": ";
    return message.starts_with(prefix) ? "file: " + message.substr(prefix.size()) : message;
  }
}

std::string refusalOfMetadata(const std::string& key, const std::string& value) {
  return refusal([&](Safetensors& content) { content.metadata[key] = value; });
}

}  // namespace

TEST_CASE("a network comes back from its file bit for bit") {
  for (const std::vector<int>& lags : {std::vector<int>{}, std::vector<int>{0}, std::vector{0, 2, 31}}) {
    const int layers = lags.empty() ? 1 : 2;
    const ScratchFolder folder;
    const std::filesystem::path path = folder / "net.safetensors";
    const network::NetworkWeights saved = sample(layers, lags);
    saveNetworkWeights(path, saved);
    const network::NetworkWeights loaded = loadNetworkWeights(path);
    CHECK(loaded.features == saved.features);
    CHECK(loaded.feature_mean == saved.feature_mean);
    CHECK(loaded.feature_scale == saved.feature_scale);
    CHECK(loaded.output_mean == saved.output_mean);
    CHECK(loaded.output_scale == saved.output_scale);
    CHECK(loaded.rate_Hz == saved.rate_Hz);
    CHECK(loaded.window == saved.window);
    CHECK(loaded.heads == saved.heads);
    CHECK(loaded.attention_scale == saved.attention_scale);
    CHECK(loaded.output == saved.output);
    CHECK(loaded.linear_lags == saved.linear_lags);

    network::AttentionLstm original(saved);
    network::AttentionLstm copy(loaded);
    const Eigen::MatrixXd features = network::randomFeatures(saved, 100, 5).transpose();
    for (Eigen::Index step = 0; step < features.cols(); ++step) {
      const std::span<const double> column(features.col(step).data(), 5);
      CHECK(original.step(column) == copy.step(column));
    }
  }
}

TEST_CASE("a file tells with which model it was trained, where a digest stands in its card") {
  const ScratchFolder folder;
  const auto told = [&](const std::map<std::string, std::string>& remarks) {
    WeightsOrigin origin{.sealed = false, .model_sha256 = "of another file"};
    saveNetworkWeights(folder / "net.safetensors", sample(1), remarks);
    loadNetworkWeights(folder / "net.safetensors", &origin);
    CHECK(origin.sealed);
    return origin.model_sha256;
  };
  const std::string digest(64, 'a');
  CHECK(told({{"card_model_sha256", digest}}) == digest);
  CHECK(told({}).empty());
  CHECK(told({{"card_model_sha256", "adult.toml"}}).empty());
  CHECK(told({{"card_model_sha256", std::string(64, '\n')}}).empty());
}

TEST_CASE("the tensors have PyTorch's names and shapes") {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "net.safetensors";
  saveNetworkWeights(path, sample(2));
  std::map<std::string, std::string> shapes;
  for (const auto& [name, tensor] : readSafetensors(path).tensors)
    shapes[name] = shapeText(tensor.shape);
  CHECK(shapes == std::map<std::string, std::string>{{"lstm.weight_ih_l0", "[512,5]"},
                                                     {"lstm.weight_hh_l0", "[512,128]"},
                                                     {"lstm.bias_ih_l0", "[512]"},
                                                     {"lstm.bias_hh_l0", "[512]"},
                                                     {"lstm.weight_ih_l1", "[512,128]"},
                                                     {"lstm.weight_hh_l1", "[512,128]"},
                                                     {"lstm.bias_ih_l1", "[512]"},
                                                     {"lstm.bias_hh_l1", "[512]"},
                                                     {"fc.weight", "[64,128]"},
                                                     {"fc.bias", "[64]"},
                                                     {"attention.in_proj_weight", "[192,64]"},
                                                     {"attention.in_proj_bias", "[192]"},
                                                     {"attention.out_proj.weight", "[64,64]"},
                                                     {"attention.out_proj.bias", "[64]"},
                                                     {"output.weight", "[2,64]"},
                                                     {"output.bias", "[2]"}});
}

TEST_CASE("a missing, unexpected or wrongly shaped tensor is refused with its name") {
  CHECK(refusal([](Safetensors&) {}) == "accepted");
  CHECK(refusal([](Safetensors& f) { f.tensors.erase("fc.bias"); }) == "file: tensor 'fc.bias': missing");
  CHECK(refusal([](Safetensors& f) { f.tensors.erase("lstm.weight_hh_l0"); }) ==
        "file: tensor 'lstm.weight_hh_l0': missing");
  CHECK(refusal([](Safetensors& f) {
          f.tensors["norm.weight"] = {{64}, std::vector<float>(64)};
        }) == "file: tensor 'norm.weight': shape [64], no such tensor expected");
  CHECK(refusal([](Safetensors& f) {
          f.tensors["lstm.weight_ih_l2"] = {{1}, {0.0F}};
        }) == "file: tensor 'lstm.weight_ih_l2': shape [1], no such tensor expected");
  CHECK(refusal([](Safetensors& f) {
          f.tensors["lstm.weight_ih_l0"] = {{512, 6}, std::vector<float>(3072)};
        }) == "file: tensor 'lstm.weight_ih_l0': shape [512,6], expected [512,5]");
  CHECK(refusal([](Safetensors& f) {
          f.tensors["fc.weight"].shape = {128, 64};
        }) == "file: tensor 'fc.weight': shape [128,64], expected [128,128]");
  CHECK(refusal([](Safetensors& f) {
          f.tensors["output.bias"].shape = {2, 1};
        }) == "file: tensor 'output.bias': shape [2,1], expected [2]");
  CHECK(refusal([](Safetensors& f) { f.tensors["fc.weight"].shape = {8192}; }) ==
        "file: tensor 'fc.weight': shape [8192], expected a matrix");
  CHECK(refusal([](Safetensors& f) {
          f.tensors["output.weight"] = {{0, 64}, {}};
        }) == "file: tensor 'output.weight': shape [0,64], expected sizes from 1 to 4096");
}

TEST_CASE("metadata that is missing or makes no sense is refused with its key") {
  for (const std::string key : {"features", "feature_mean", "feature_scale", "output_mean", "output_scale",
                                "rate_Hz", "window", "heads", "attention_scale", "output"})
    CHECK(refusal([&](Safetensors& f) { f.metadata.erase(key); }) == "file: metadata '" + key + "': missing");
  CHECK(refusalOfMetadata("format", "pt") == "accepted");
  CHECK(refusalOfMetadata("heads", "eight") == "file: metadata 'heads': 'eight', expected an integer");
  CHECK(refusalOfMetadata("heads", "8.5") == "file: metadata 'heads': '8.5', expected an integer");
  CHECK(refusalOfMetadata("heads", "99999999999") ==
        "file: metadata 'heads': '99999999999', expected an integer");
  CHECK(refusalOfMetadata("heads", "7") == "file: heads: 7, expected a divisor of the 64 channels");
  CHECK(refusalOfMetadata("window", "-1") == "file: window = -1, expected 1 to 4096");
  CHECK(refusalOfMetadata("rate_Hz", "") == "file: metadata 'rate_Hz': '', expected a number");
  CHECK(refusalOfMetadata("feature_mean", "0,0,,0,0") ==
        "file: metadata 'feature_mean': '', expected a number");
  CHECK(refusalOfMetadata("feature_mean", "0,0,0,0") == "file: feature_mean: 4 values, expected 5");
  CHECK(refusalOfMetadata("feature_scale", "1,1,nan,1,1").starts_with("file: feature_scale[3] = nan"));
  CHECK(refusalOfMetadata("feature_scale", "1,1,0,1,1").starts_with("file: feature_scale[3] = 0"));
  CHECK(refusalOfMetadata("features", "a,b,c,d,d") == "file: features: 'd' appears twice");
  CHECK(refusalOfMetadata("features", "a,b") ==
        "file: tensor 'lstm.weight_ih_l0': shape [512,5], expected [512,2]");
  CHECK(refusalOfMetadata("attention_scale", "sqrt") ==
        "file: metadata 'attention_scale': 'sqrt', expected inv_sqrt or none");
  CHECK(refusalOfMetadata("output", "newton")
            .starts_with("file: metadata 'output': 'newton', expected acceleration_rad_s2 or torque_Nm or"));
}

TEST_CASE("a linear path needs its tensor and its lags") {
  const auto spoilt = [](const std::function<void(Safetensors&)>& spoil) { return refusal(spoil, {0, 3}); };
  const auto lags = [&](const std::string& value) {
    return spoilt([&](Safetensors& f) { f.metadata["linear_lags"] = value; });
  };
  CHECK(lags("0,3") == "accepted");
  CHECK(spoilt([](Safetensors& f) { f.metadata.erase("linear_lags"); }) ==
        "file: metadata 'linear_lags': missing");
  CHECK(spoilt([](Safetensors& f) { f.tensors.erase("linear.weight"); }) ==
        "file: tensor 'linear.weight': missing");
  CHECK(spoilt([](Safetensors& f) {
          f.tensors["linear.weight"].shape = {10, 2};
        }) == "file: tensor 'linear.weight': shape [10,2], expected [2,10]");
  CHECK(spoilt([](Safetensors& f) {
          f.tensors["linear.weight"].values[3] = std::nanf("");
        }).starts_with("file: tensor 'linear.weight'"));
  CHECK(spoilt([](Safetensors& f) { f.tensors.erase("linear.bound"); }) ==
        "file: tensor 'linear.bound': missing");
  CHECK(spoilt([](Safetensors& f) {
          f.tensors["linear.bound"].shape = {2, 1};
        }) == "file: tensor 'linear.bound': shape [2,1], expected [2]");
  CHECK(spoilt([](Safetensors& f) { f.tensors["linear.bound"].values[1] = -0.5F; }) ==
        "file: tensor 'linear.bound': -0.500000, expected positive numbers");
  CHECK(spoilt([](Safetensors& f) { f.tensors["linear.bound"].values[0] = std::nanf(""); }) ==
        "file: tensor 'linear.bound': element 0 is not a finite float32");
  CHECK(refusal([](Safetensors& f) {
          f.tensors["linear.bound"] = {{2}, {1.0F, 1.0F}};
        }) == "file: tensor 'linear.bound': shape [2], no such tensor expected");
  CHECK(lags("0,3,5") == "file: tensor 'linear.weight': shape [2,10], expected [2,15]");
  CHECK(lags("") == "file: metadata 'linear_lags': '', expected integers, separated by commas");
  CHECK(lags("0 3") == "file: metadata 'linear_lags': '0 3', expected integers, separated by commas");
  CHECK(lags("0,-3") == "file: linear_lags: -3 after 0, expected more, up to 4095");
  CHECK(lags("0,99999999999") ==
        "file: metadata 'linear_lags': '99999999999', expected integers, separated by commas");
  CHECK(lags("3,0") == "file: linear_lags: 3 first, expected 0");
  CHECK(lags("0,2147483647") == "file: linear_lags: 2147483647 after 0, expected more, up to 4095");
}

TEST_CASE("weights that the loader would refuse are not saved") {
  const ScratchFolder folder;
  network::NetworkWeights weights = sample(1);
  weights.output_bias.setZero(1);
  CHECK_THROWS_WITH_AS(saveNetworkWeights(folder / "f", weights),
                       ((folder / "f").string() + ": tensor 'output.bias': shape [1], expected [2]").c_str(),
                       std::runtime_error);
  CHECK(folder.entries() == 0);
}

}  // namespace patella::app
