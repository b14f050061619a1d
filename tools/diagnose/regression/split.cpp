// A part of recordings to fit, and a part to judge by.
#include <cmath>
#include <utility>

#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

// Postures have no order in time, and often one in angle: the last of them would be one end of the range. So
// runs of neighbours are held out, spread over the whole.
void splitPostures(const Segment& segment, double heldout_fraction, std::vector<Segment>& train,
                   std::vector<Segment>& heldout) {
  constexpr std::size_t kNeighbours = 5;
  const auto share = [&](std::size_t row) {
    const std::size_t group = row / kNeighbours;
    return std::floor(heldout_fraction * static_cast<double>(group + 1)) >
           std::floor(heldout_fraction * static_cast<double>(group));
  };
  for (std::size_t first = segment.first; first < segment.end;) {
    const bool out = share(first - segment.first);
    std::size_t end = first;
    while (end < segment.end && share(end - segment.first) == out) {
      ++end;
    }
    (out ? heldout : train).push_back({first, end});
    first = end;
  }
}

}  // namespace

SplitRecordings split(std::span<const Recording> recordings, double heldout_fraction) {
  SplitRecordings parts;
  for (const Recording& recording : recordings) {
    Recording train = recording;
    Recording heldout = recording;
    train.segments.clear();
    heldout.segments.clear();
    for (const Segment& segment : recording.segments) {
      if (recording.is_static) {
        splitPostures(segment, heldout_fraction, train.segments, heldout.segments);
        continue;
      }
      const auto length = static_cast<double>(segment.end - segment.first);
      const auto cut = segment.first + static_cast<std::size_t>((1.0 - heldout_fraction) * length);
      const double shortest = readable::kShortest_s * recording.rate_Hz;
      if (heldout_fraction * length < shortest || (1.0 - heldout_fraction) * length < shortest) {
        train.segments.push_back(segment);
      } else {
        train.segments.push_back({segment.first, cut});
        // Friction, play and heat remember: the model runs up to the cut before it is judged.
        heldout.segments.push_back({segment.first, segment.end, cut - segment.first});
      }
    }
    parts.train.push_back(std::move(train));
    if (!heldout.segments.empty()) {
      parts.heldout.push_back(std::move(heldout));
    }
  }
  return parts;
}

}  // namespace patella::diagnose
