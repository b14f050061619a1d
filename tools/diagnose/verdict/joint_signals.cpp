#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/excitation.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

using offline::Samples;

constexpr double kBand_Hz = 10.0;
constexpr int kOrder = 4;
constexpr double kSmoothing_Hz = 40.0;

struct Moved {
  double range = 0.0;
  double square = 0.0;  // of velocity, summed
  double rows = 0.0;
  double resolution = 0.0;  // encoder step or noise, whichever is larger
};

Samples part(const std::vector<double>& signal, const Segment& segment) {
  return {signal.begin() + static_cast<std::ptrdiff_t>(segment.first),
          signal.begin() + static_cast<std::ptrdiff_t>(segment.end)};
}

// Smallest differences between neighbours that are not zero.
double encoderStep(const Samples& position) {
  Samples steps;
  for (std::size_t i = 1; i < position.size(); ++i) {
    const double step = std::abs(position[i] - position[i - 1]);
    if (step > 0.0) {
      steps.push_back(step);
    }
  }
  constexpr double kSmall = 0.1;
  return steps.empty() ? 0.0 : offline::quantile(steps, kSmall);
}

void add(Moved& moved, double& low, double& high, const Samples& position, double rate_Hz) {
  const double band_Hz = std::min(kBand_Hz, 0.2 * rate_Hz);
  const Samples slow = offline::zeroPhaseLowPass(position, band_Hz, rate_Hz, kOrder);
  const Samples smooth =
      offline::zeroPhaseLowPass(position, std::min(kSmoothing_Hz, 0.3 * rate_Hz), rate_Hz, kOrder);
  const Samples velocity = offline::derivative(slow, rate_Hz);
  low = std::min(low, *std::min_element(slow.begin(), slow.end()));
  high = std::max(high, *std::max_element(slow.begin(), slow.end()));
  for (const double value : velocity) {
    moved.square += value * value;
  }
  moved.rows += static_cast<double>(velocity.size());
  const double noise = offline::rms(offline::difference(position, smooth));
  moved.resolution = std::max({moved.resolution, noise, encoderStep(position)});
}

Moved movedOf(std::span<const Recording> recordings, std::size_t joint) {
  Moved moved;
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  for (const Recording& recording : recordings) {
    for (const Segment& segment : recording.segments) {
      const Samples position = part(recording.position_rad[joint], segment);
      if (recording.is_static) {
        low = std::min(low, *std::min_element(position.begin(), position.end()));
        high = std::max(high, *std::max_element(position.begin(), position.end()));
      } else if (static_cast<double>(position.size()) >= readable::kShortest_s * recording.rate_Hz) {
        add(moved, low, high, position, recording.rate_Hz);
      }
    }
  }
  moved.range = std::max(0.0, high - low);
  return moved;
}

struct Line {
  double share = 0.0;
  double frequency_Hz = 0.0;
};

// Share of a signal's power that a sinusoid of this frequency explains.
double lineShare(const Samples& signal, double frequency_Hz, double rate_Hz) {
  const std::complex<double> turn = std::polar(1.0, 2.0 * std::numbers::pi * frequency_Hz / rate_Hz);
  std::complex<double> now = 1.0;
  std::complex<double> sum = 0.0;
  double power = 0.0;
  for (const double value : signal) {
    sum += value * now;
    power += value * value;
    now *= turn;
  }
  return power > 0.0 ? 2.0 * std::norm(sum) / (static_cast<double>(signal.size()) * power) : 0.0;
}

// The strongest line of the longest stretch, without its first and last seconds where machines swing in and
// out.
Line strongestLine(const Recording& recording, std::size_t joint) {
  constexpr double kSwing_s = 3.0;
  constexpr double kRate_Hz = 40.0;
  constexpr double kFractionOfBin = 0.2;
  const Segment& longest =
      *std::max_element(recording.segments.begin(), recording.segments.end(),
                        [](const Segment& a, const Segment& b) { return a.end - a.first < b.end - b.first; });
  Samples position =
      offline::zeroPhaseLowPass(part(recording.position_rad[joint], longest),
                                std::min(kBand_Hz, 0.2 * recording.rate_Hz), recording.rate_Hz, kOrder);
  const auto swing = static_cast<std::ptrdiff_t>(kSwing_s * recording.rate_Hz);
  if (static_cast<std::ptrdiff_t>(position.size()) > 4 * swing) {
    position = {position.begin() + swing, position.end() - swing};
  }
  const Samples all = offline::derivative(position, recording.rate_Hz);
  const auto step = static_cast<std::size_t>(std::max(1.0, std::floor(recording.rate_Hz / kRate_Hz)));
  Samples velocity;
  for (std::size_t i = 0; i < all.size(); i += step) {
    velocity.push_back(all[i]);
  }
  const double rate_Hz = recording.rate_Hz / static_cast<double>(step);
  const double bin_Hz = kFractionOfBin * rate_Hz / static_cast<double>(velocity.size());
  Line line;
  for (double f = 5.0 * bin_Hz; f < std::min(kBand_Hz, 0.4 * rate_Hz); f += bin_Hz) {
    const double share = lineShare(velocity, f, rate_Hz);
    if (share > line.share) {
      line = {.share = share, .frequency_Hz = f};
    }
  }
  return line;
}

// Recordings of different frequencies together hold more than one line.
Line commonLine(std::span<const Recording> recordings, std::size_t joint) {
  Line common{.share = 1.0};
  for (const Recording& recording : recordings) {
    if (recording.is_static) {
      return {};
    }
    const Line line = strongestLine(recording, joint);
    if (common.frequency_Hz > 0.0 &&
        std::abs(line.frequency_Hz - common.frequency_Hz) > motion::kSameFrequency * common.frequency_Hz) {
      return {};
    }
    common = {.share = std::min(common.share, line.share), .frequency_Hz = line.frequency_Hz};
  }
  return common;
}

// A torque that sits at its highest or lowest value, and hardly ever near it, is cut off there.
void addClipping(std::vector<double> torque, JointSignals& signals) {
  std::sort(torque.begin(), torque.end());
  const auto look = [&](auto begin, auto end) {
    const auto next = std::find_if(begin, end, [&](double value) { return value != *begin; });
    const auto after = std::find_if(next, end, [&](double value) { return value != *next; });
    const auto count = static_cast<std::size_t>(next - begin);
    if (*begin == 0.0 || next == end || count <= motion::kPileUp * static_cast<std::size_t>(after - next)) {
      return 0.0;
    }
    return static_cast<double>(count) / static_cast<double>(torque.size());
  };
  const double low = look(torque.begin(), torque.end());
  const double high = look(torque.rbegin(), torque.rend());
  if (low + high > signals.clipped_share) {
    signals.clipped_share = low + high;
    signals.clipped_Nm = low > high ? torque.front() : torque.back();
  }
}

bool constant(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [&](double value) { return value == values.front(); });
}

}  // namespace

std::vector<JointSignals> jointSignals(std::span<const Recording> recordings) {
  std::vector<JointSignals> all;
  double fastest = 0.0;
  const bool at_rest = !recordings.empty() && recordings.front().is_static;
  for (std::size_t j = 0; j < static_cast<std::size_t>(recordings.front().joints); ++j) {
    const Moved moved = movedOf(recordings, j);
    JointSignals signals{.position_range_rad = moved.range,
                         .velocity_rms_rad_s = moved.rows > 0.0 ? std::sqrt(moved.square / moved.rows) : 0.0};
    signals.moves = at_rest ? moved.range > motion::kLeastPostures_rad
                            : signals.velocity_rms_rad_s > motion::kLeastVelocity_rad_s &&
                                  moved.range > motion::kLeastSteps * moved.resolution;
    signals.constant_torque = true;
    for (const Recording& recording : recordings) {
      signals.constant_torque = signals.constant_torque && constant(recording.torque_Nm[j]);
      addClipping(recording.torque_Nm[j], signals);
    }
    if (signals.moves) {
      const Line line = commonLine(recordings, j);
      signals.line_share = line.share;
      signals.line_Hz = line.frequency_Hz;
    }
    fastest = std::max(fastest, signals.velocity_rms_rad_s);
    all.push_back(signals);
  }
  for (JointSignals& signals : all) {
    signals.moves =
        signals.moves && (at_rest || signals.velocity_rms_rad_s > motion::kLeastShareOfOther * fastest);
  }
  return all;
}

}  // namespace patella::diagnose
