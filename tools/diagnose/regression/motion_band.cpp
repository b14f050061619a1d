#include "tools/diagnose/regression/motion_band.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

using offline::Samples;

// Frequency below which 99 % of the power of a velocity lies, as far as a coarse list tells.
double powerEdge_Hz(const Samples& velocity, double rate_Hz) {
  constexpr double kRest = 0.1;  // of the amplitude: 1 % of the power
  const double whole = offline::rms(velocity);
  constexpr std::array kEdges_Hz{1.0, 1.5, 2.0, 2.5, 3.0};
  for (const double edge_Hz : kEdges_Hz) {
    const Samples slow = offline::zeroPhaseLowPass(velocity, edge_Hz, rate_Hz, kFilterOrder);
    if (offline::rms(offline::difference(velocity, slow)) < kRest * whole) {
      return edge_Hz;
    }
  }
  return kEdges_Hz.back() + 0.5;
}

}  // namespace

double motionBand_Hz(std::span<const Recording> recordings) {
  constexpr double kBandPerEdge = 2.5;
  constexpr double kSmoothing_Hz = 20.0;
  double edge_Hz = 0.0;
  for (const Recording& recording : recordings) {
    for (const Segment& segment : recording.segments) {
      if (recording.is_static ||
          static_cast<double>(segment.end - segment.first) < readable::kShortest_s * recording.rate_Hz) {
        continue;
      }
      for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
        const auto first = recording.position_rad[j].begin();
        const Samples stretch(first + static_cast<std::ptrdiff_t>(segment.first),
                              first + static_cast<std::ptrdiff_t>(segment.end));
        const Samples position = offline::zeroPhaseLowPass(
            stretch, std::min(kSmoothing_Hz, 0.2 * recording.rate_Hz), recording.rate_Hz, kFilterOrder);
        edge_Hz = std::max(edge_Hz,
                           powerEdge_Hz(offline::derivative(position, recording.rate_Hz), recording.rate_Hz));
      }
    }
  }
  return std::clamp(kBandPerEdge * edge_Hz, 6.0, DatasetOptions{}.band_Hz);
}

}  // namespace patella::diagnose
