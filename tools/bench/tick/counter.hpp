// Units in which a stage is measured.
#pragma once

#include <cstdint>

namespace patella::bench {

enum class Unit { kNanoseconds, kInstructions };

/// A number that only grows while this thread runs.
class Counter {
 public:
  /// Instructions are this thread's in user space, see perf_event_open(2). Throws std::system_error where
  /// kernel or processor do not count them.
  explicit Counter(Unit unit);
  ~Counter();
  Counter(const Counter&) = delete;
  Counter& operator=(const Counter&) = delete;

  std::int64_t read() const noexcept;
  Unit unit() const noexcept { return unit_; }

 private:
  Unit unit_;
  int descriptor_ = -1;
};

}  // namespace patella::bench
