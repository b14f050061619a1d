// Keeps the account of a run: counts what the loop did, and hands it to the recorder.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "core/safety/fault.hpp"
#include "firmware_app/loop/loop_sink.hpp"
#include "firmware_app/realtime/allocation_counter.hpp"
#include "firmware_app/realtime/page_faults.hpp"
#include "firmware_app/recorder/loop_statistics.hpp"
#include "firmware_app/recorder/recorder.hpp"
#include "firmware_app/recorder/tick_record.hpp"

namespace patella::app {

struct AccountOptions {
  int warmup_ticks = 200;  ///< heap operations and page faults are counted from here on
};

class RunAccount final : public LoopSink {
 public:
  /// `recorder` may be null, and must outlive the account.
  explicit RunAccount(const AccountOptions& options = {}, Recorder* recorder = nullptr);

  void begin() noexcept override;
  void end() noexcept override;
  void frame(const can::Frame& frame) noexcept PATELLA_NONBLOCKING override;
  void tick(const TickReport& report) noexcept PATELLA_NONBLOCKING override;
  void tickEnded(bool overrun, std::uint32_t missed) noexcept override;

  /// Complete once the loop has ended.
  const LoopStatistics& statistics() const noexcept { return *statistics_; }

 private:
  /// Page faults and heap operations of the loop's thread up to some instant.
  struct Usage {
    HeapCounts heap;
    ThreadUsage thread;
  };
  Usage usage() const noexcept;
  safety::WarningSet recorderWarnings() noexcept PATELLA_NONBLOCKING;
  void count(const TickReport& report) noexcept PATELLA_NONBLOCKING;
  void countSafety(const TickReport& report) noexcept PATELLA_NONBLOCKING;
  void countEstimates(const TickReport& report) noexcept PATELLA_NONBLOCKING;

  AccountOptions options_;
  Recorder* recorder_;
  std::unique_ptr<LoopStatistics> statistics_;
  TickRecord record_;
  safety::FaultSet previous_faults_;
  std::optional<CountAllocations> heap_;  ///< of the loop's thread
  Usage warm_;
};

}  // namespace patella::app
