// The recent past of one signal, for effects that answer late.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace patella::model {

/// Between two samples the signal is linear, or held at the later one's value, as the reader says. Samples
/// that follow each other faster than every 0.1 ms are thinned out to that; the newest always counts. The
/// capacity is thereby independent of the rate.
template <int kLongestDelay_ms>
class DelayLine {
 public:
  /// The signal has always been `value`.
  void reset(double value) noexcept {
    clock_s_ = 0.0;
    newest_ = 0;
    points_.fill({0.0, std::isfinite(value) ? value : 0.0});
  }

  /// The signal is `value`, dt_s after the sample before; a value that is no number stands for the one
  /// before.
  void push(double value, double dt_s) noexcept {
    if (!(dt_s > 0.0)) {
      return;
    }
    clock_s_ += dt_s;
    const double last = points_[newest_].value;
    // Until it is far enough from the one before, the newest point gives way to the next.
    if (points_[newest_].time_s - points_[before(newest_)].time_s >= kSpacing_s) {
      newest_ = (newest_ + 1) % kPoints;
    }
    points_[newest_] = {clock_s_, std::isfinite(value) ? value : last};
  }

  /// The signal `delay_s` before now, where now is `elapsed_s` after the newest sample and the signal is
  /// `value`; before the memory begins, its first value.
  double at(double delay_s, double elapsed_s, double value, bool held = false) const noexcept {
    if (!(delay_s > 0.0)) {
      return value;
    }
    // A held signal that is wanted at the instant of a sample is that of the step before, whatever the
    // rounding.
    const double wanted_s = clock_s_ + (elapsed_s - delay_s) - (held ? kTie_s : 0.0);
    if (wanted_s >= clock_s_) {
      return between(points_[newest_], {clock_s_ + elapsed_s, value}, wanted_s, held);
    }
    // The last of the points, in the order of time, that is not later than wanted.
    std::size_t early = 0;
    std::size_t late = kPoints - 1;
    if (fromOldest(early).time_s >= wanted_s) {
      return fromOldest(early).value;
    }
    // Samples mostly follow each other evenly, and then it is one of these; rounding may shift it by one.
    const double step_s = clock_s_ - points_[before(newest_)].time_s;
    const auto guess = kPoints - 1 -
                       static_cast<std::size_t>(std::min(static_cast<double>(kPoints - 3),
                                                         std::floor((clock_s_ - wanted_s) / step_s)));
    for (std::size_t order = guess - 2; order <= guess + 1; ++order) {
      if (order > early && order < late) {
        (fromOldest(order).time_s <= wanted_s ? early : late) = order;
      }
    }
    while (late - early > 1) {
      const std::size_t middle = (early + late) / 2;
      (fromOldest(middle).time_s <= wanted_s ? early : late) = middle;
    }
    return between(fromOldest(early), fromOldest(late), wanted_s, held);
  }

 private:
  struct Point {
    double time_s;
    double value;
  };

  // Less than 0.1 ms, so that rounding does not let every other sample of that period go.
  static constexpr double kSpacing_s = 0.95e-4;
  static constexpr double kTie_s = 1e-9;
  static constexpr std::size_t kPoints = static_cast<std::size_t>(kLongestDelay_ms * 1e-3 / kSpacing_s) + 4;

  static std::size_t before(std::size_t index) noexcept { return (index + kPoints - 1) % kPoints; }
  const Point& fromOldest(std::size_t order) const noexcept {
    const std::size_t index = newest_ + 1 + order;
    return points_[index < kPoints ? index : index - kPoints];
  }

  static double between(const Point& a, const Point& b, double time_s, bool held) noexcept {
    const double span_s = b.time_s - a.time_s;
    const double share = held || !(span_s > 0.0) ? 1.0 : (time_s - a.time_s) / span_s;
    return a.value + (b.value - a.value) * share;
  }

  double clock_s_ = 0.0;  ///< of the newest sample, since reset
  std::size_t newest_ = 0;
  std::array<Point, kPoints> points_{};
};

}  // namespace patella::model
