#include "core/tick/features.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace patella::tick {

namespace {

std::array<std::string, kFeatureCount> names() {
  std::array<std::string, kFeatureCount> all;
  const auto number = [&all](int first, int count, const std::string& stem, const std::string& unit) {
    for (int i = 0; i < count; ++i) {
      all[static_cast<std::size_t>(first + i)] = stem + std::to_string(i + 1) + unit;
    }
  };
  number(kPosition, kMaxJoints, "q", "_rad");
  number(kVelocity, kMaxJoints, "dq", "_rad_s");
  number(kTorque, kMaxJoints, "tau", "_Nm");
  number(kEmgTorque, kMaxJoints, "tau_emg", "_Nm");
  number(kActivation, kMaxEmgChannels, "activation", "");
  number(kObserver, kMaxJoints, "f_s", "_rad_s2");
  number(kObserverFiltered, kMaxJoints, "f_s_filtered", "_rad_s2");
  number(kObserverTorque, kMaxJoints, "d_hat", "_Nm");
  number(kAcceleration, kMaxJoints, "ddq_hat", "_rad_s2");
  for (int i = 0; i < kRiseTimes; ++i) {
    const auto rise_ms = std::lround(1000.0 * kRiseTimes_s[static_cast<std::size_t>(i)]);
    number(kRise + i * kMaxJoints, kMaxJoints, "d_rise_" + std::to_string(rise_ms) + "ms", "_Nm");
  }
  all[kTime] = "time_s";
  return all;
}

/// Joint from 0 of a feature; 0 for what belongs to none.
int jointOf(int feature) noexcept {
  if (feature == kTime || (feature >= kActivation && feature < kObserver)) {
    return 0;
  }
  return (feature < kActivation ? feature : feature - kObserver) % kMaxJoints;
}

}  // namespace

const std::array<std::string_view, kFeatureCount>& featureNames() noexcept {
  static const std::array<std::string, kFeatureCount> kTexts = names();
  static const std::array<std::string_view, kFeatureCount> kNames = [] {
    std::array<std::string_view, kFeatureCount> views;
    std::copy(kTexts.begin(), kTexts.end(), views.begin());
    return views;
  }();
  return kNames;
}

FeatureSelection selectFeatures(const std::vector<std::string>& names, int joints) {
  FeatureSelection selection;
  const auto& known = featureNames();
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end() || jointOf(static_cast<int>(found - known.begin())) >= joints) {
      std::string message = "feature '" + name + "' of the network is unknown, expected one of";
      for (int feature = 0; feature < kFeatureCount; ++feature) {
        if (jointOf(feature) < joints) {
          message += ' ';
          message += known[static_cast<std::size_t>(feature)];
        }
      }
      throw std::invalid_argument(message);
    }
    selection.push_back(static_cast<int>(found - known.begin()));
  }
  return selection;
}

}  // namespace patella::tick
