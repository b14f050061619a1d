// How long a row of unlike jobs will still take.
#pragma once

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <string>

namespace patella::study {

/// "3 min", "40 s".
inline std::string durationText(double seconds) {
  const auto whole = std::lround(seconds);
  return whole < 120 ? std::to_string(whole) + " s" : std::to_string(std::lround(seconds / 60.0)) + " min";
}

/// Jobs of two kinds; each is taken to last as long as the mean of its kind so far.
class Pace {
 public:
  enum Kind : std::size_t { kObserver, kNetwork };

  void expect(Kind kind) { ++kinds_[kind].left; }
  void begin() { begun_ = Clock::now(); }
  void end(Kind kind) {
    kinds_[kind].spent_s += std::chrono::duration<double>(Clock::now() - begun_).count();
    ++kinds_[kind].done;
    --kinds_[kind].left;
  }
  /// A result that was kept.
  void skip(Kind kind) { --kinds_[kind].left; }

  /// "12 min left"; what the present job still takes is given, where it knows. Says so where a kind has not
  /// been timed yet.
  std::string left(double present_s = 0.0, bool in_network = false) const {
    double seconds = present_s;
    for (std::size_t kind = 0; kind < kinds_.size(); ++kind) {
      const Jobs& jobs = kinds_[kind];
      const int waiting = jobs.left - (in_network && kind == kNetwork ? 1 : 0);
      if (waiting > 0 && jobs.done == 0 && !(in_network && kind == kNetwork)) {
        return "time left not known yet";
      }
      const double each_s = jobs.done > 0
                                ? jobs.spent_s / jobs.done
                                : std::chrono::duration<double>(Clock::now() - begun_).count() + present_s;
      seconds += waiting * each_s;
    }
    return durationText(seconds) + " left";
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Jobs {
    int left = 0;
    int done = 0;
    double spent_s = 0.0;
  };

  std::array<Jobs, 2> kinds_{};
  Clock::time_point begun_ = Clock::now();
};

}  // namespace patella::study
