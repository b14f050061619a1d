#include "firmware_app/weights/network_weights_file.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "drivers/joined.hpp"
#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/wording.hpp"
#include "firmware_app/weights/safetensors_file.hpp"

namespace patella::app {

namespace {

using network::AttentionScale;
using network::NetworkShape;
using network::NetworkWeights;
using network::OutputKind;

constexpr std::array<std::pair<std::string_view, AttentionScale>, 2> kAttentionScales = {
    {{"inv_sqrt", AttentionScale::kInvSqrt}, {"none", AttentionScale::kNone}}};
constexpr std::array<std::pair<std::string_view, OutputKind>, 4> kOutputKinds = {
    {{"acceleration_rad_s2", OutputKind::kAcceleration},
     {"torque_Nm", OutputKind::kTorque},
     {"acceleration_correction_rad_s2", OutputKind::kAccelerationCorrection},
     {"torque_correction_Nm", OutputKind::kTorqueCorrection}}};

constexpr const char* kLinearLags = "linear_lags";

/// Typed access to the metadata. What is asked for is required: a default for a scale or a unit would be a
/// guess.
class MetadataReader {
 public:
  MetadataReader(std::string file, const std::map<std::string, std::string>& metadata)
      : file_(std::move(file)), metadata_(metadata) {}

  std::vector<std::string> names(const std::string& key) const {
    const std::string& value = text(key);
    std::vector<std::string> parts;
    std::size_t begin = 0;
    for (std::size_t comma = value.find(','); comma != std::string::npos; comma = value.find(',', begin)) {
      parts.push_back(value.substr(begin, comma - begin));
      begin = comma + 1;
    }
    parts.push_back(value.substr(begin));
    return parts;
  }

  Eigen::VectorXd numbers(const std::string& key) const {
    const std::vector<std::string> parts = names(key);
    Eigen::VectorXd values(static_cast<Eigen::Index>(parts.size()));
    std::transform(parts.begin(), parts.end(), values.begin(),
                   [&](const std::string& part) { return parse<double>(key, part, "a number"); });
    return values;
  }

  std::vector<int> integers(const std::string& key) const {
    std::vector<int> values;
    for (const std::string& part : names(key))
      values.push_back(parse<int>(key, part, "integers, separated by commas"));
    return values;
  }

  bool has(const std::string& key) const { return metadata_.count(key) != 0; }
  double number(const std::string& key) const { return parse<double>(key, text(key), "a number"); }
  int integer(const std::string& key) const { return parse<int>(key, text(key), "an integer"); }

  template <typename Value, std::size_t kCount>
  Value choice(const std::string& key,
               const std::array<std::pair<std::string_view, Value>, kCount>& choices) const {
    const std::string& value = text(key);
    for (const auto& [name, meaning] : choices) {
      if (name == value)
        return meaning;
    }
    fail(key, "'" + value + "', expected " +
                  joined(choices, " or ", [](const auto& choice) { return choice.first; }));
  }

 private:
  [[noreturn]] void fail(const std::string& key, const std::string& what) const {
    throw FileError(file_ + ": metadata '" + key + "': " + what);
  }

  const std::string& text(const std::string& key) const {
    const auto found = metadata_.find(key);
    if (found == metadata_.end())
      fail(key, "missing");
    return found->second;
  }

  template <typename Number>
  Number parse(const std::string& key, const std::string& value, const char* expected) const {
    Number number{};
    const char* end = value.data() + value.size();
    const auto [stopped, error] = std::from_chars(value.data(), end, number);
    if (error != std::errc() || stopped != end)
      fail(key, "'" + value + "', expected " + expected);
    return number;
  }

  std::string file_;
  const std::map<std::string, std::string>& metadata_;
};

/// Fills matrices from the file's tensors, taking each out, so that what is left over is what is unexpected.
class TensorReader {
 public:
  TensorReader(std::string file, std::map<std::string, Tensor> tensors)
      : file_(std::move(file)), tensors_(std::move(tensors)) {}

  bool has(const std::string& name) const { return tensors_.count(name) != 0; }

  /// Size of a matrix along `axis`, from which other shapes follow.
  Eigen::Index size(const std::string& name, std::size_t axis) const {
    const Tensor& tensor = find(name);
    const std::int64_t rank = 2;
    if (std::ssize(tensor.shape) != rank)
      fail(name, "shape " + shapeText(tensor.shape) + ", expected a matrix");
    const std::int64_t size = tensor.shape[axis];
    if (size < 1 || size > network::kMaxWidth)
      fail(name, "shape " + shapeText(tensor.shape) + ", expected sizes from 1 to " +
                     std::to_string(network::kMaxWidth));
    return static_cast<Eigen::Index>(size);
  }

  template <typename Matrix>
  void take(const std::string& name, Matrix& target, Eigen::Index rows, Eigen::Index cols) {
    const Tensor& tensor = find(name);
    std::vector<std::int64_t> expected = {rows};
    if (Matrix::ColsAtCompileTime != 1)
      expected.push_back(cols);
    if (tensor.shape != expected)
      fail(name, "shape " + shapeText(tensor.shape) + ", expected " + shapeText(expected));
    target = Eigen::Map<const Matrix>(tensor.values.data(), rows, cols);
    tensors_.erase(name);
  }

  void checkNothingLeft() const {
    if (!tensors_.empty())
      fail(tensors_.begin()->first,
           "shape " + shapeText(tensors_.begin()->second.shape) + ", no such tensor expected");
  }

 private:
  [[noreturn]] void fail(const std::string& name, const std::string& what) const {
    throw FileError(file_ + ": tensor '" + name + "': " + what);
  }

  const Tensor& find(const std::string& name) const {
    const auto found = tensors_.find(name);
    if (found == tensors_.end())
      fail(name, "missing");
    return found->second;
  }

  std::string file_;
  std::map<std::string, Tensor> tensors_;
};

template <typename Value, std::size_t kCount>
std::string nameOf(Value value, const std::array<std::pair<std::string_view, Value>, kCount>& choices) {
  const auto* found = std::find_if(choices.begin(), choices.end(),
                                   [&](const auto& choice) { return choice.second == value; });
  return std::string(found->first);
}

/// What is no SHA-256 is a remark of somebody else's.
std::string digestIn(const std::map<std::string, std::string>& metadata, const std::string& key) {
  constexpr std::size_t kDigits = 64;
  const auto found = metadata.find(key);
  const bool digest = found != metadata.end() && found->second.size() == kDigits &&
                      found->second.find_first_not_of("0123456789abcdef") == std::string::npos;
  return digest ? found->second : "";
}

}  // namespace

std::string unsealedWarning(const std::filesystem::path& path) {
  return path.string() +
         ": no digest: damaged weights cannot be told from good ones; 'patella-train seal FILE' adds one to "
         "a "
         "file that is known to be good";
}

network::NetworkWeights loadNetworkWeights(const std::filesystem::path& path, WeightsOrigin* origin) {
  Safetensors content = readSafetensors(path);
  if (origin != nullptr)
    *origin = {content.sealed, digestIn(content.metadata, kModelDigest)};
  NetworkWeights weights;
  const MetadataReader metadata(path.string(), content.metadata);
  weights.features = metadata.names("features");
  weights.feature_mean = metadata.numbers("feature_mean");
  weights.feature_scale = metadata.numbers("feature_scale");
  weights.output_mean = metadata.numbers("output_mean");
  weights.output_scale = metadata.numbers("output_scale");
  weights.rate_Hz = metadata.number("rate_Hz");
  weights.window = metadata.integer("window");
  weights.heads = metadata.integer("heads");
  weights.attention_scale = metadata.choice("attention_scale", kAttentionScales);
  weights.output = metadata.choice("output", kOutputKinds);

  // The tensor alone would leave open what it acts on; the list alone, that a tensor was lost.
  if (metadata.has(kLinearLags) || content.tensors.count("linear.weight") != 0)
    weights.linear_lags = metadata.integers(kLinearLags);

  TensorReader tensors(path.string(), std::move(content.tensors));
  weights.lstm.resize(tensors.has("lstm.weight_ih_l1") ? 2 : 1);
  const NetworkShape shape = {.inputs = static_cast<Eigen::Index>(weights.features.size()),
                              .hidden = tensors.size("lstm.weight_hh_l0", 1),
                              .layers = static_cast<Eigen::Index>(weights.lstm.size()),
                              .channels = tensors.size("fc.weight", 0),
                              .outputs = tensors.size("output.weight", 0)};
  network::visitTensors(weights, shape,
                        [&](const std::string& name, auto& tensor, Eigen::Index rows, Eigen::Index cols) {
                          tensors.take(name, tensor, rows, cols);
                        });
  tensors.checkNothingLeft();
  try {
    network::checkWeights(weights);
  } catch (const std::invalid_argument& error) {
    throw FileError(path.string() + ": " + error.what());
  }
  return weights;
}

void saveNetworkWeights(const std::filesystem::path& path, const network::NetworkWeights& weights,
                        const std::map<std::string, std::string>& remarks) {
  try {
    network::checkWeights(weights);
  } catch (const std::invalid_argument& error) {
    throw FileError(path.string() + ": " + error.what());
  }
  Safetensors content;
  content.metadata = {{"features", joined(weights.features, ",")},
                      {"feature_mean", joined(weights.feature_mean, ",", formatNumber)},
                      {"feature_scale", joined(weights.feature_scale, ",", formatNumber)},
                      {"output_mean", joined(weights.output_mean, ",", formatNumber)},
                      {"output_scale", joined(weights.output_scale, ",", formatNumber)},
                      {"rate_Hz", formatNumber(weights.rate_Hz)},
                      {"window", std::to_string(weights.window)},
                      {"heads", std::to_string(weights.heads)},
                      {"attention_scale", nameOf(weights.attention_scale, kAttentionScales)},
                      {"output", nameOf(weights.output, kOutputKinds)}};
  if (!weights.linear_lags.empty())
    content.metadata[kLinearLags] =
        joined(weights.linear_lags, ",", [](int lag) { return std::to_string(lag); });
  content.metadata.insert(remarks.begin(), remarks.end());
  network::visitTensors(weights, network::shapeOf(weights),
                        [&](const std::string& name, const auto& tensor, Eigen::Index, Eigen::Index) {
                          Tensor& stored = content.tensors[name];
                          stored.shape = {tensor.rows()};
                          if (std::decay_t<decltype(tensor)>::ColsAtCompileTime != 1)
                            stored.shape.push_back(tensor.cols());
                          stored.values.assign(tensor.data(), tensor.data() + tensor.size());
                        });
  writeSafetensors(path, content);
}

}  // namespace patella::app
