#include "tools/bench/tick/stage_meter.hpp"

#include <algorithm>
#include <limits>

namespace patella::bench {

using tick::Stage;

StageMeter::StageMeter(const Counter& counter, std::uint64_t warmup) noexcept
    : counter_(counter), warmup_(warmup) {
  // The least of many means: of a clock that ticks more coarsely, and undisturbed by other programs.
  constexpr int kBlocks = 200;
  constexpr int kReadings = 100;
  overhead_ = std::numeric_limits<std::int64_t>::max();
  for (int block = 0; block < kBlocks; ++block) {
    const std::int64_t before = counter_.read();
    for (int i = 0; i < kReadings; ++i) {
      counter_.read();
    }
    overhead_ = std::min(overhead_, (counter_.read() - before) / (kReadings + 1));
  }
}

void StageMeter::enter(Stage stage) noexcept PATELLA_NONBLOCKING {
  const std::int64_t now = counter_.read();
  spent_[static_cast<std::size_t>(stage_)] += now - since_ - overhead_;
  since_ = now;
  stage_ = stage;
  if (stage == Stage::kOutside) {
    endTick();
    since_ = counter_.read();
  }
}

void StageMeter::endTick() noexcept {
  spent_[static_cast<std::size_t>(Stage::kOutside)] = 0;
  if (++ticks_ > warmup_) {
    std::int64_t whole = 0;
    for (std::size_t i = 0; i < spent_.size(); ++i) {
      total_[i] += spent_[i];
      histograms_[i].add(spent_[i]);
      whole += spent_[i];
    }
    whole_.add(whole);
  }
  spent_.fill(0);
}

double StageMeter::median(Stage stage) const noexcept {
  return static_cast<double>(of(stage).quantile(0.5));
}

double StageMeter::mean(Stage stage) const noexcept {
  return static_cast<double>(total_[static_cast<std::size_t>(stage)]) /
         static_cast<double>(std::max<std::uint64_t>(ticks(), 1));
}

double StageMeter::meanOfTick() const noexcept {
  double sum = 0.0;
  for (std::size_t i = 0; i < tick::kStageCount; ++i) {
    sum += mean(static_cast<Stage>(i));
  }
  return sum;
}

}  // namespace patella::bench
