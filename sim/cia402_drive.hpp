// A CANopen drive after CiA 402 in cyclic synchronous torque, with a motor behind a gear.
#pragma once

#include <cstdint>

#include "sim/field_drive.hpp"
#include "sim/object_dictionary.hpp"

namespace patella::sim {

/// Object dictionary with SDO server, network management, heartbeats both ways, PDOs that can be mapped anew
/// while they are off, SYNC, emergencies, and the states of CiA 402. Torque is a whole number of thousandths
/// of the motor's rated torque. Without the heartbeat that 1016h:1 names, and without SYNC for
/// watchdog_s, an enabled drive falls into a fault.
class Cia402Drive final : public FieldDrive {
 public:
  explicit Cia402Drive(const FieldDriveOptions& options);

 private:
  enum class State : std::uint8_t { kSwitchOnDisabled, kReady, kSwitchedOn, kQuickStop, kFault };

  bool hear(const can::Frame& frame, const JointReading& joint, std::int64_t now_ns,
            FrameSink& replies) noexcept override;
  void report(const JointReading& joint, std::int64_t now_ns, FrameSink& frames) noexcept override;
  void starved() noexcept override;
  void forget() noexcept override;

  void manage(const can::Frame& frame) noexcept;
  void serve(const can::Frame& frame, FrameSink& replies) noexcept;
  AbortCode allow(const DictionaryObject& object, std::uint32_t value) const noexcept;
  AbortCode allowMapping(unsigned communication, const DictionaryObject& object,
                         std::uint32_t value) const noexcept;
  void written(const DictionaryObject& object) noexcept;
  void receive(const can::Frame& frame, std::int64_t now_ns) noexcept;
  void transmit(const JointReading& joint, FrameSink& replies) noexcept;
  void obey(std::uint32_t controlword, std::int64_t now_ns) noexcept;
  void fall(std::uint32_t code) noexcept;
  void settle() noexcept;
  void put(FrameSink& sink, const can::Frame& frame) const noexcept;
  can::Frame blank(std::uint32_t base, int length) const noexcept;
  std::uint32_t statusWord() const noexcept;
  double newtonMetresPerMille() const noexcept;

  ObjectDictionary dictionary_;
  SdoServer server_;
  std::int64_t sync_timeout_ns_;  ///< 0: none
  State state_ = State::kSwitchOnDisabled;
  std::uint8_t network_state_;
  bool starting_ = true;  ///< has not told of its start yet
  bool emergency_ = false;
  bool was_enabled_ = false;
  std::uint32_t controlword_ = 0;
  std::int64_t sync_ns_ = 0;
  std::int64_t next_heartbeat_ns_ = 0;
};

}  // namespace patella::sim
