#include "tools/recordings/torque_clipping.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace patella::diagnose {

void warnOfClipping(const std::vector<double>& torque, std::size_t joint,
                    std::vector<std::string>& warnings) {
  constexpr double kShare = 0.01;
  constexpr std::size_t kPileUp = 5;
  std::vector<double> sorted = torque;
  std::sort(sorted.begin(), sorted.end());
  if (sorted.front() == sorted.back()) {
    return;
  }
  const auto look = [&](auto begin, auto end) {
    const auto next = std::find_if(begin, end, [&](double value) { return value != *begin; });
    const auto after = std::find_if(next, end, [&](double value) { return value != *next; });
    const auto count = static_cast<std::size_t>(next - begin);
    const double share = static_cast<double>(count) / static_cast<double>(sorted.size());
    if (share > kShare && count > kPileUp * static_cast<std::size_t>(after - next) && *begin != 0.0) {
      warnings.push_back(
          fmt::format("torque of joint {} is clipped at {:.4g} N·m in {:.1f} % of the recording", joint + 1,
                      *begin, 100.0 * share));
    }
  };
  look(sorted.begin(), sorted.end());
  look(sorted.rbegin(), sorted.rend());
}

}  // namespace patella::diagnose
