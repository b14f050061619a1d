// From frames on the bus to the measurement of a tick.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

#include "core/measurement.hpp"
#include "core/safety/fault.hpp"
#include "core/types.hpp"
#include "drivers/can/bad_frames.hpp"
#include "drivers/can/bus_map.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"
#include "drivers/can/drive_reports.hpp"
#include "drivers/can/input_table.hpp"
#include "drivers/can/message_codec.hpp"
#include "drivers/can/sample_set.hpp"

namespace patella::can {

/// Plain numbers since construction, one set per bound message.
struct MessageStatistics {
  std::uint64_t received = 0;
  std::uint64_t corrupt = 0;       ///< CRC, or too short
  std::uint64_t repeated = 0;      ///< by the counter
  std::uint64_t reordered = 0;     ///< counter further on than time allows: old, or not the sender's
  std::uint64_t lost = 0;          ///< gaps in the counter
  std::uint64_t out_of_range = 0;  ///< a bound signal out of its declared range, or an implausible position
  std::uint64_t late = 0;          ///< used, but came after its group's timeout
};

struct Reading {
  Measurement measurement;
  safety::FaultSet faults;
  BusSet fault_buses = 0;  ///< on which something is missing or damaged, as the faults say
  bool complete = false;   ///< every bound input has been seen, but for those that are only recorded
};

/// Inputs that can be bound: position_rad.J (required for each joint), velocity_rad_s.J and drive_torque_Nm.J
/// (each for all joints or none), drive_enabled and drive_fault, of all drives or, with .J, of a joint's;
/// drive_temperature_degC.J and drive_error.J, which are only recorded; emg_mV.N, operator_enable,
/// operator_reset, true_f_u.J.
///
/// A frame that fails by CRC, repeats its counter or holds a value out of range changes no input. A value
/// that is only recorded becomes NaN where it is out of range; f_u of a simulated rig stays as it was.
class MeasurementDecoder {
 public:
  /// Throws std::invalid_argument naming input, message or signal, and what exists; also where
  /// checkBindings() refuses the map.
  MeasurementDecoder(const Database& database, const BusMap& map, int joints);

  /// Takes one frame, in order of arrival. Own echoes, error reports and remote requests are passed over.
  void accept(const Frame& frame) noexcept PATELLA_NONBLOCKING;

  /// Ends the tick's intake. Faults are levels: they are there as long as their cause is. Groups count as
  /// stale only once they have been seen; before that the reading is not complete.
  Reading finish(std::int64_t now_ns) noexcept PATELLA_NONBLOCKING;

  /// Longest age of an encoder sample that may be acted on, ns.
  std::int64_t encoderTimeout_ns() const noexcept { return timeouts_ns_[kEncoderGroup]; }

  /// Bound messages in the order of their first binding.
  std::size_t messageCount() const noexcept { return messages_.size(); }
  std::string_view messageName(std::size_t message) const noexcept {
    return messages_[message].decoder.layout().name();
  }
  const MessageStatistics& statistics(std::size_t message) const noexcept {
    return messages_[message].statistics;
  }
  /// Frames of identifiers that no input is bound to.
  std::uint64_t unknownFrames() const noexcept { return unknown_frames_; }

 private:
  static constexpr std::size_t kMaxIndex = kMaxEmgChannels > kMaxJoints ? kMaxEmgChannels : kMaxJoints;
  static constexpr std::size_t kMaxInputs = kInputCount * kMaxIndex;

  struct BoundInput {
    Input input = Input::kPosition;
    std::uint8_t index = 0;
    std::size_t slot = 0;
    double scale = 1.0;
    double offset = 0.0;
    std::vector<double> good{};
    std::uint32_t mask = 0;
  };

  struct BoundMessage {
    explicit BoundMessage(MessageDecoder message_decoder) : decoder(std::move(message_decoder)) {}
    MessageDecoder decoder;
    std::vector<BoundInput> inputs;
    std::array<bool, kInputGroupCount> groups{};
    std::int64_t timeout_ns = std::numeric_limits<std::int64_t>::max();  ///< shortest of its groups
    std::int64_t period_ns = 0;
    std::int64_t sample = 0;  ///< running number of its newest frame by the counter
    std::int64_t last_monotonic_ns = 0;
    std::int64_t last_wall_ns = 0;
    std::int64_t used_monotonic_ns = 0;
    bool started = false;  ///< a frame with a valid CRC has come
    bool used = false;     ///< a frame has been used
    BadFrames corrupt, sequence, implausible;
    MessageStatistics statistics;
  };

  using Values = std::array<double, kMaxInputs>;

  static InputId inputIn(const Binding& binding, int joints);
  BoundMessage& boundMessage(const Database& database, const BusMap& map, const std::string& name);
  void bind(const Database& database, const BusMap& map, const Binding& binding);
  void requireAllOrNone(Input input) const;
  void requireOneForm(Input all, Input one) const;
  bool isBound(Input input, std::size_t index) const noexcept;
  bool isBound(Input input) const noexcept { return isBound(input, 0); }
  bool followSequence(BoundMessage& message, const Frame& frame) noexcept;
  int mostSteps(const BoundMessage& message, const Frame& frame) const noexcept;
  bool readValues(const BoundMessage& message, const Frame& frame, Values& values) const noexcept;
  bool plausiblePosition(const BoundMessage& message, const Frame& frame, const BoundInput& input,
                         double position_rad) const noexcept;
  void store(BoundMessage& message, const Frame& frame, const Values& values) noexcept;
  void storeInput(const BoundMessage& message, const Frame& frame, const BoundInput& input,
                  double value) noexcept;
  std::int64_t periodsSince(const BoundMessage& message, const Frame& frame,
                            const BoundInput& input) const noexcept;
  bool nextSample(const BoundMessage& message, const Frame& frame, const BoundInput& input) noexcept;
  std::int64_t sampleNumber(const BoundInput& input) const noexcept {
    return samples_[static_cast<std::size_t>(input.input)][input.index].number;
  }
  static bool judge(const BoundInput& input, double value) noexcept;
  BusSet stale(InputGroup group, std::int64_t now_ns) const noexcept;

  int joints_;
  std::size_t indices_;  ///< that some input has: joints or EMG channels
  std::array<std::int64_t, kInputGroupCount> timeouts_ns_{};
  double position_min_rad_;
  double position_max_rad_;
  double position_jump_rad_;
  int tolerated_;
  std::vector<BoundMessage> messages_;
  std::array<std::array<bool, kMaxIndex>, kInputCount> bound_{};
  std::array<std::array<bool, kMaxIndex>, kInputCount> seen_{};
  std::array<std::array<std::uint8_t, kMaxIndex>, kInputCount> buses_{};  ///< on which it comes
  std::array<std::array<std::int64_t, kMaxIndex>, kInputCount> stored_ns_{};
  struct Sample {
    std::int64_t number = 0;
    std::int64_t wall_ns = 0, monotonic_ns = 0;  ///< of the frame that it was counted by
  };
  std::array<std::array<Sample, kMaxIndex>, kInputCount> samples_{};  ///< of positions and EMG
  std::array<std::int64_t, kMaxJoints> arrived_ns_{};  ///< of each joint's position, on the loop's clock
  SampleSet<kMaxJoints> encoder_samples_;
  SampleSet<kMaxEmgChannels> emg_samples_;
  Measurement measurement_;
  DriveReports drive_reports_;
  /// Not yet seen released since the operator's silence: a cable that is put back is no press.
  bool enable_stuck_ = false;
  bool reset_stuck_ = false;
  std::uint64_t unknown_frames_ = 0;
};

}  // namespace patella::can
