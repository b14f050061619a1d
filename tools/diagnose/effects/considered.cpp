#include "tools/diagnose/effects/considered.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>

#include "core/model/effect.hpp"

namespace patella::diagnose {

std::vector<std::string> consideredKinds(const std::vector<std::string>& asked) {
  std::vector<std::string> kinds;
  for (const model::EffectDescriptor* descriptor : model::effectCatalogue()) {
    kinds.emplace_back(descriptor->kind);
  }
  if (asked.empty()) {
    return kinds;
  }
  for (const std::string& kind : asked) {
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) {
      throw std::invalid_argument(
          fmt::format("effect kind '{}' is unknown, expected one of {}", kind, fmt::join(kinds, ", ")));
    }
  }
  return asked;
}

std::vector<std::string> commonKinds() {
  return {"coulomb_friction", "viscous_friction", "linear_stiffness", "torque_bias", "payload"};
}

std::vector<int> recordedChannels(std::span<const Recording> recordings) {
  std::vector<int> channels;
  for (int channel = 0; channel < kMaxEmgChannels; ++channel) {
    const bool everywhere = std::all_of(recordings.begin(), recordings.end(), [channel](const Recording& r) {
      const auto& values = r.activation[static_cast<std::size_t>(channel)];
      return !values.empty() && *std::max_element(values.begin(), values.end()) > 0.0;
    });
    if (everywhere) {
      channels.push_back(channel + 1);
    }
  }
  return channels;
}

}  // namespace patella::diagnose
