// Counts what each stage of a tick takes.
#pragma once

#include <array>
#include <cstdint>

#include "core/tick/stage_probe.hpp"
#include "firmware_app/recorder/latency_histogram.hpp"
#include "tools/bench/tick/counter.hpp"

namespace patella::bench {

class StageMeter final : public tick::StageProbe {
 public:
  /// The counter must outlive the meter. The first `warmup` ticks are not counted. What reading the counter
  /// takes is found here and taken off.
  StageMeter(const Counter& counter, std::uint64_t warmup) noexcept;

  void enter(tick::Stage stage) noexcept PATELLA_NONBLOCKING override;

  std::uint64_t ticks() const noexcept { return ticks_ > warmup_ ? ticks_ - warmup_ : 0; }
  /// Mean of a tick, in the counter's unit.
  double mean(tick::Stage stage) const noexcept;
  double median(tick::Stage stage) const noexcept;
  double meanOfTick() const noexcept;
  const app::LatencyHistogram& of(tick::Stage stage) const noexcept {
    return histograms_[static_cast<std::size_t>(stage)];
  }
  const app::LatencyHistogram& ofTick() const noexcept { return whole_; }

 private:
  void endTick() noexcept;

  const Counter& counter_;
  std::uint64_t warmup_;
  std::int64_t overhead_ = 0;
  std::uint64_t ticks_ = 0;
  tick::Stage stage_ = tick::Stage::kOutside;
  std::int64_t since_ = 0;
  std::array<std::int64_t, tick::kStageCount> spent_{};  ///< in this tick
  std::array<std::int64_t, tick::kStageCount> total_{};
  std::array<app::LatencyHistogram, tick::kStageCount> histograms_{};
  app::LatencyHistogram whole_;
};

}  // namespace patella::bench
