#include "core/tick/features.hpp"

#include <algorithm>
#include <stdexcept>

namespace patella::tick {

const std::array<std::string_view, kFeatureCount>& featureNames() noexcept {
  static constexpr std::array<std::string_view, kFeatureCount> kNames = {"q1_rad",
                                                                         "q2_rad",
                                                                         "dq1_rad_s",
                                                                         "dq2_rad_s",
                                                                         "tau1_Nm",
                                                                         "tau2_Nm",
                                                                         "tau_emg1_Nm",
                                                                         "tau_emg2_Nm",
                                                                         "activation1",
                                                                         "activation2",
                                                                         "activation3",
                                                                         "activation4",
                                                                         "f_s1_rad_s2",
                                                                         "f_s2_rad_s2",
                                                                         "f_s_filtered1_rad_s2",
                                                                         "f_s_filtered2_rad_s2",
                                                                         "d_hat1_Nm",
                                                                         "d_hat2_Nm",
                                                                         "ddq_hat1_rad_s2",
                                                                         "ddq_hat2_rad_s2",
                                                                         "d_rise_20ms1_Nm",
                                                                         "d_rise_20ms2_Nm",
                                                                         "d_rise_60ms1_Nm",
                                                                         "d_rise_60ms2_Nm",
                                                                         "d_rise_180ms1_Nm",
                                                                         "d_rise_180ms2_Nm",
                                                                         "time_s"};
  return kNames;
}

FeatureSelection selectFeatures(const std::vector<std::string>& names) {
  FeatureSelection selection;
  const auto& known = featureNames();
  for (const std::string& name : names) {
    const auto found = std::find(known.begin(), known.end(), name);
    if (found == known.end()) {
      std::string message = "feature '" + name + "' of the network is unknown, expected one of";
      for (const std::string_view& candidate : known) {
        message += ' ';
        message += candidate;
      }
      throw std::invalid_argument(message);
    }
    selection.push_back(static_cast<int>(found - known.begin()));
  }
  return selection;
}

}  // namespace patella::tick
