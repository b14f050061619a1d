#include "tools/train/windows.hpp"

#include <algorithm>

namespace patella::train {

std::vector<Window> drawWindows(std::span<const Sequence> sequences, Eigen::Index length,
                                Eigen::Index burn_in, sim::Random& random) {
  const auto below = [&random](Eigen::Index limit) {
    return static_cast<Eigen::Index>(random.uniform() * static_cast<double>(limit));
  };
  std::vector<Window> windows;
  for (std::size_t s = 0; s < sequences.size(); ++s) {
    const Eigen::Index steps = sequences[s].steps();
    const Eigen::Index hop = length - burn_in;
    for (Eigen::Index end = 1 + below(hop); end < steps + hop; end += hop) {
      const Eigen::Index begin = std::max<Eigen::Index>(0, end - length);
      const Eigen::Index learned = begin == 0 ? 0 : burn_in;
      const Eigen::Index count = std::min(end, steps) - begin;
      const auto role = sequences[s].role.begin() + begin;
      if (count > learned && std::find(role + learned, role + count, Role::kTrain) != role + count) {
        windows.push_back({.sequence = s, .begin = begin, .count = count, .burn_in = learned});
      }
    }
  }
  for (std::size_t i = windows.size(); i > 1; --i) {
    std::swap(windows[i - 1], windows[static_cast<std::size_t>(below(static_cast<Eigen::Index>(i)))]);
  }
  return windows;
}

}  // namespace patella::train
