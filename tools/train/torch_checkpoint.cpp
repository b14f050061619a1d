#include "tools/train/torch_checkpoint.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>
#include <torch/version.h>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/json_file.hpp"
#include "firmware_app/weights/safetensors_file.hpp"

namespace patella::train {
namespace {

constexpr const char* kIdentity = "identity";
constexpr const char* kSteps = "adam_steps";
constexpr const char* kCurve = "curve";

template <typename State, typename Visit>
void eachGroup(State& state, Visit visit) {
  visit("parameter.", state.parameters);
  visit("kept.", state.kept);
  visit("adam.mean.", state.adam.mean);
  visit("adam.square.", state.adam.square);
}

/// FNV-1a, 64 bit.
class Hash {
 public:
  template <typename Value>
  void add(const Value* values, std::size_t count) noexcept {
    const auto* bytes = reinterpret_cast<const unsigned char*>(values);
    for (std::size_t i = 0; i < count * sizeof(Value); ++i) {
      value_ = (value_ ^ bytes[i]) * 0x100000001b3ULL;
    }
  }
  void add(const Rows& rows) noexcept { add(rows.data(), static_cast<std::size_t>(rows.size())); }
  std::uint64_t value() const noexcept { return value_; }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

/// Parts of an identity, each a name and a value.
std::vector<std::string> partsOf(const std::string& identity) {
  constexpr std::string_view kBetween = ", ";
  std::vector<std::string> parts;
  for (std::size_t from = 0; from <= identity.size();) {
    const std::size_t to = std::min(identity.find(kBetween, from), identity.size());
    parts.push_back(identity.substr(from, to - from));
    from = to + kBetween.size();
  }
  return parts;
}

/// "there epochs 5, here epochs 9" for each part that is another; all of it where the parts are not the same.
std::string differences(const std::string& there, const std::string& here) {
  const std::vector<std::string> theirs = partsOf(there);
  const std::vector<std::string> ours = partsOf(here);
  if (theirs.size() != ours.size()) {
    return "there " + there + ", here " + here;
  }
  std::string text;
  for (std::size_t i = 0; i < ours.size(); ++i) {
    if (theirs[i] != ours[i]) {
      text += (text.empty() ? "there " : "; there ") + theirs[i] + ", here " + ours[i];
    }
  }
  return text;
}

}  // namespace

void saveCheckpoint(const std::filesystem::path& path, const std::string& identity,
                    const TrainingState& state) {
  app::Safetensors content;
  eachGroup(state, [&](const char* prefix, const NamedTensors& tensors) {
    for (const auto& [name, tensor] : tensors) {
      const torch::Tensor values = tensor.detach().contiguous();
      content.tensors[prefix + name] = {
          values.sizes().vec(), {values.data_ptr<float>(), values.data_ptr<float>() + values.numel()}};
    }
  });
  nlohmann::json curve = nlohmann::json::array();
  for (const Epoch& epoch : state.curve) {
    // Hexadecimal: to the bit, and with a NaN where there is no validation.
    curve.push_back({fmt::format("{:a}", epoch.training), fmt::format("{:a}", epoch.validation)});
  }
  content.metadata = {
      {kIdentity, identity}, {kSteps, std::to_string(state.adam.steps)}, {kCurve, curve.dump()}};
  app::writeSafetensors(path, content);
}

void loadCheckpoint(const std::filesystem::path& path, const std::string& identity, TrainingState& state) {
  const app::Safetensors content = app::readSafetensors(path, files::kCheckpoint);
  const auto text = [&](const char* key) -> const std::string& {
    const auto found = content.metadata.find(key);
    if (found == content.metadata.end()) {
      throw app::FileError(path.string() + ": metadata '" + key +
                           "': missing, expected a checkpoint of patella-train");
    }
    return found->second;
  };
  if (text(kIdentity) != identity) {
    throw app::FileError(path.string() + ": is the checkpoint of a training with other options or data (" +
                         differences(text(kIdentity), identity) + "); remove it to begin anew");
  }
  eachGroup(state, [&](const char* prefix, NamedTensors& tensors) {
    for (auto& [name, tensor] : tensors) {
      const auto found = content.tensors.find(prefix + name);
      if (found == content.tensors.end() || found->second.shape != tensor.sizes().vec()) {
        throw app::FileError(path.string() + ": tensor '" + prefix + name +
                             "': missing or of another shape than the network's");
      }
      std::copy(found->second.values.begin(), found->second.values.end(), tensor.data_ptr<float>());
    }
  });
  try {
    state.adam.steps = std::stoll(text(kSteps));
    state.curve.clear();
    for (const auto& epoch : app::parseJson(text(kCurve), kCurve)) {
      state.curve.push_back({std::strtod(epoch.at(0).get<std::string>().c_str(), nullptr),
                             std::strtod(epoch.at(1).get<std::string>().c_str(), nullptr)});
    }
  } catch (const std::exception& error) {
    throw app::FileError(path.string() + ": damaged checkpoint: " + error.what());
  }
}

std::string identityOf(std::span<const Sequence> sequences, const network::NetworkWeights& frame,
                       const TrainingOptions& o) {
  Hash data;
  for (const Sequence& sequence : sequences) {
    data.add(sequence.features);
    data.add(targetOf(sequence, frame.output));
    data.add(sequence.role.data(), sequence.role.size());
  }
  for (const Eigen::VectorXd* scaling :
       {&frame.feature_mean, &frame.feature_scale, &frame.output_mean, &frame.output_scale}) {
    data.add(scaling->data(), static_cast<std::size_t>(scaling->size()));
  }
  return fmt::format(
      "data {:016x}, rate {}, output {}, layers {}, hidden {}, channels {}, heads {}, window {}, attention "
      "{}, "
      "loss {}, stopping {}, patience {}, epochs {}, batch {}, steps {}, burn-in {}, learning rate {}, decay "
      "{}, "
      "seed {}, threads {}, initialisation {} {}, linear lags {} by loss {}, libtorch {}",
      data.value(), frame.rate_Hz, static_cast<int>(frame.output), o.layers, o.hidden, o.channels, o.heads,
      o.window, static_cast<int>(o.attention_scale), static_cast<int>(o.loss), static_cast<int>(o.stopping),
      o.patience, o.epochs, o.batch, o.sequence_steps, o.burn_in, o.learning_rate, o.weight_decay, o.seed,
      o.threads, static_cast<int>(o.initialisation), o.turn_s, fmt::join(o.linear_lags, " "),
      static_cast<int>(o.linear_loss), TORCH_VERSION);
}

}  // namespace patella::train
