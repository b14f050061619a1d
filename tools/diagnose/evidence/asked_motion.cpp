#include "tools/diagnose/evidence/asked_motion.hpp"

#include <algorithm>
#include <cmath>

#include "tools/signals/signals.hpp"
#include "tools/signals/spectral_lines.hpp"

namespace patella::diagnose::evidence {
namespace {

constexpr double kWindow_s = 0.5;
/// Times the median of the windows, from which a deviation is none of the ordinary ones.
constexpr double kBeyond = 4.0;
/// Largest share of a stretch that is cut off at each end.
constexpr double kMost = 0.2;
constexpr std::size_t kFewestWindows = 5;

// rms of what the sinusoids leave of a position in each window of a stretch.
std::vector<double> deviations(const std::vector<double>& position, const std::vector<double>& asked,
                               const Segment& segment, std::size_t window) {
  std::vector<double> all;
  for (std::size_t first = segment.first; first + window <= segment.end; first += window) {
    double sum = 0.0;
    for (std::size_t k = first; k < first + window; ++k) {
      sum += (position[k] - asked[k]) * (position[k] - asked[k]);
    }
    all.push_back(std::sqrt(sum / static_cast<double>(window)));
  }
  return all;
}

}  // namespace

void keepAskedMotion(Recording& recording, double highest_Hz) {
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    for (const Segment& segment : recording.segments) {
      const auto first = recording.position_rad[j].begin() + static_cast<std::ptrdiff_t>(segment.first);
      const offline::Samples position(first,
                                      first + static_cast<std::ptrdiff_t>(segment.end - segment.first));
      const offline::Samples lines =
          offline::lineSpectrumPart(position, recording.rate_Hz, {.highest_Hz = highest_Hz});
      std::copy(lines.begin(), lines.end(), first);
    }
  }
}

void cutToAskedMotion(Recording& recording, double highest_Hz) {
  Recording asked = recording;
  keepAskedMotion(asked, highest_Hz);
  const auto window = static_cast<std::size_t>(std::max(1.0, kWindow_s * recording.rate_Hz));
  for (Segment& segment : recording.segments) {
    std::size_t from = 0, to = 0;  // windows cut off at the ends
    for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
      const std::vector<double> deviation =
          deviations(recording.position_rad[j], asked.position_rad[j], segment, window);
      if (deviation.size() < kFewestWindows) {
        continue;
      }
      const double ordinary = kBeyond * offline::median(deviation);
      const auto most = static_cast<std::size_t>(kMost * static_cast<double>(deviation.size()));
      for (std::size_t i = 0; i < most; ++i) {
        from = deviation[i] > ordinary ? std::max(from, i + 1) : from;
        to = deviation[deviation.size() - 1 - i] > ordinary ? std::max(to, i + 1) : to;
      }
    }
    segment.first += from * window;
    segment.end -= to * window;
  }
}

}  // namespace patella::diagnose::evidence
