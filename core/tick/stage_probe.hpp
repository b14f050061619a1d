// The stages of a tick, for those who measure it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/types.hpp"

namespace patella::tick {

/// In the order of a tick. The observer and the network are left out by ticks without a new encoder sample.
enum class Stage : std::uint8_t {
  kReceive,         ///< frames from the bus
  kDecode,          ///< frames to a measurement
  kLinesIn,         ///< emergency stop, and what the watching thread found
  kEmg,             ///< envelope and activation
  kModel,           ///< velocity, known terms with their effects, low-pass of the estimate
  kObserver,        ///< whatever observer is configured
  kNetworkStep,     ///< phase one: what needs the newest sample
  kControl,         ///< reference and control law
  kSafety,          ///< limits, monitors, state machine
  kEncode,          ///< command to a frame
  kSend,            ///< last check, and frame to the bus
  kLinesOut,        ///< drive enable and heartbeat
  kAccount,         ///< the tick into the statistics and the record of the run
  kRecord,          ///< frames into the recorder's rings
  kNetworkPrepare,  ///< phase two: what the next tick can have ready
  kOutside,         ///< the tick has ended
  kCount
};
inline constexpr std::size_t kStageCount = static_cast<std::size_t>(Stage::kCount);

inline constexpr std::array<std::string_view, kStageCount> kStageNames = {
    "receive", "decode", "lines in", "emg",       "model",   "observer", "network 1", "control",
    "safety",  "encode", "send",     "lines out", "account", "record",   "network 2", "outside"};

/// Told of every transition within a tick.
class StageProbe {
 public:
  virtual ~StageProbe() = default;
  virtual void enter(Stage stage) noexcept PATELLA_NONBLOCKING = 0;
};

/// Where nobody measures, a transition costs a comparison.
inline void enter(StageProbe* probe, Stage stage) noexcept PATELLA_NONBLOCKING {
  if (probe != nullptr) {
    probe->enter(stage);
  }
}

}  // namespace patella::tick
