// The whole rig as the loop meets it: a peer on the bus that sends encoder, drive, EMG and operator frames
// and obeys torque commands.
#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/model/dynamics_model.hpp"
#include "core/model/one_dof.hpp"
#include "core/model/planar_two_link.hpp"
#include "core/spsc_ring.hpp"
#include "core/types.hpp"
#include "drivers/can/can_frame.hpp"
#include "drivers/can/dbc.hpp"
#include "sim/drive.hpp"
#include "sim/emg_generator.hpp"
#include "sim/encoder.hpp"
#include "sim/fault_injector.hpp"
#include "sim/field_drives.hpp"
#include "sim/interaction_force.hpp"
#include "sim/plant.hpp"
#include "sim/recorded_emg.hpp"
#include "sim/rig_messages.hpp"

namespace patella::sim {

using MechanismParameters = std::variant<model::PlanarTwoLinkParameters, model::RevoluteJointParameters,
                                         model::PrismaticJointParameters>;

struct EffectOptions {
  std::string kind;  ///< as in the effect catalogue
  int joint = 0;     ///< from 0
  std::vector<double> parameters;
};

/// Actions of the person at the rig.
struct OperatorOptions {
  double enable_at_s = 0.0;        ///< enable level rises; infinity: never
  std::vector<double> reset_at_s;  ///< starts of presses of the reset button, 0.1 s each
};

/// Everything there is to choose. Times count from the rig's first instant.
struct RigOptions {
  MechanismParameters mechanism;                       ///< as it is
  std::optional<MechanismParameters> known_mechanism;  ///< as the loop believes; empty: as it is
  std::vector<EffectOptions> known_effects;            ///< in the truth and in the loop's model
  std::vector<EffectOptions> hidden_effects;           ///< in the truth alone
  InteractionOptions interaction;
  EmgOptions emg;
  std::filesystem::path emg_log;  ///< sends the EMG of this log instead; empty: the generator's
  EncoderOptions encoder;
  DriveOptions drive;
  std::vector<FieldDriveOptions> field_drives;  ///< one for each joint, in place of `drive`; empty: none
  OperatorOptions operator_buttons;
  std::vector<double> initial_q_rad;             ///< empty: zero
  std::vector<double> initial_dq_rad_s;          ///< empty: at rest
  std::int64_t sensor_period_ns = 1'000'000;     ///< encoder, drive status, EMG and truth
  std::int64_t operator_period_ns = 10'000'000;  ///< a multiple of the sensor period
  double max_step_s = 1e-4;                      ///< of the integrator
  bool publish_truth = true;
  std::vector<FaultEvent> faults;  ///< what goes wrong; those of the loop's host are not the rig's
  std::uint64_t seed = 1;
  std::size_t buses = 1;            ///< the messages of the database, and the drives, say on which they are
  std::size_t queue_frames = 4096;  ///< frames not yet taken off the rig, a power of two
};

struct RigStatistics {
  std::uint64_t samples = 0;
  std::uint64_t frames_dropped = 0;  ///< the queue was full
  std::uint64_t commands_accepted = 0;
  std::uint64_t commands_rejected = 0;  ///< CRC, length or repeated counter
  std::uint64_t watchdog_trips = 0;
  double max_torque_Nm = 0.0;  ///< largest torque applied on any joint
};

/// Deterministic in its options and in the calls made to it. Not thread-safe: one thread drives it.
///
/// Sensors sample at the first instant and every sensor period after it. A sample is made of the state at
/// that very instant, of the torque that acted up to it, and of f_u (Truth) averaged over the period that
/// ended with it, which is what an estimator of the step can be held against; at the first instant, where no
/// period has passed, Truth is the value there. f_u is relative to the loop's model and to the torque the
/// drives apply.
class Rig {
 public:
  /// Builds truth and the loop's model from the options. Throws std::invalid_argument where a value is out of
  /// range, naming it, or the database lacks a message or signal of the rig; can::LogError for the EMG log.
  Rig(const RigOptions& options, const can::Database& database);
  /// The same with models made elsewhere; mechanism and effects of the options are not looked at.
  Rig(const RigOptions& options, model::DynamicsModel truth, model::DynamicsModel known,
      const can::Database& database);

  /// Lives up to and including `to_ns`, of any clock that does not go back; the first call sets the rig's
  /// first instant. Frames come into the queue with monotonic_ns the instant of their sample on that clock,
  /// and wall_ns with the script's steps of a wall clock on top.
  void advance(std::int64_t to_ns) noexcept PATELLA_NONBLOCKING;
  /// A frame on the bus, at the instant to which the rig has advanced: a valid torque command acts from there
  /// on, an invalid one is counted, anything else is not for the rig.
  void accept(const can::Frame& frame) noexcept PATELLA_NONBLOCKING;
  /// Oldest frame not yet taken; false when there is none.
  bool pop(can::Frame& frame) noexcept PATELLA_NONBLOCKING { return queue_.pop(frame); }

  int joints() const noexcept { return plant_.joints(); }
  std::int64_t sensorPeriod_ns() const noexcept { return sensor_period_ns_; }
  const Plant& plant() const noexcept { return plant_; }
  const Drive& drive() const noexcept { return drive_; }
  const FieldDrives& fieldDrives() const noexcept { return field_drives_; }
  const EmgGenerator& emg() const noexcept { return emg_; }
  RigStatistics statistics() const noexcept;
  /// By script: the rig's side of these buses is gone. May be asked from any thread.
  can::BusSet interfacesDown() const noexcept { return interfaces_down_.load(std::memory_order_relaxed); }
  std::size_t buses() const noexcept { return buses_; }
  /// By script: what the wall clock was set forth by, ns; for the stamps of frames.
  std::int64_t wallStep_ns() const noexcept { return faults_.wallStep_ns(); }
  const FaultInjector& faults() const noexcept { return faults_; }

 private:
  void start(std::int64_t now_ns) noexcept;
  void integrateTo(std::int64_t instant_ns) noexcept;
  void sample() noexcept;
  void sampleFaults(double time_s) noexcept;
  void send(const can::Frame& frame, FrameChannel channel) noexcept;
  void queue(can::Frame frame) noexcept;
  void obey(const can::Frame& frame) noexcept;
  JointReading read(std::size_t joint) noexcept;
  const JointVector& torque() noexcept {
    return field_drives_.any() ? field_drives_.torque() : drive_.torque();
  }
  void sampleDrives() noexcept;
  void reportError(std::uint32_t error_class, can::BusSet buses) noexcept;
  bool resetPressed(double time_s) const noexcept;

  std::size_t buses_;
  std::int64_t sensor_period_ns_;
  std::uint64_t samples_per_operator_frame_;
  double max_step_s_;
  bool slow_drive_;
  bool publish_truth_;
  OperatorOptions operator_;

  Plant plant_;
  Drive drive_;
  FieldDrives field_drives_;
  EmgGenerator emg_;
  std::optional<RecordedEmg> recorded_emg_;
  std::vector<Encoder> encoders_;
  RigMessages messages_;
  SpscRing<can::Frame> queue_;
  /// Frames of the drives, through the faults of the bus.
  class DriveSink final : public FrameSink {
   public:
    DriveSink(Rig& rig, std::uint8_t bus) noexcept : rig_(rig), bus_(bus) {}
    void put(const can::Frame& frame) noexcept override {
      can::Frame sent = frame;
      sent.bus = bus_;
      rig_.send(sent, FrameChannel::kDriveStatus);
    }

   private:
    Rig& rig_;
    std::uint8_t bus_;
  };
  FaultInjector faults_;
  std::atomic<can::BusSet> interfaces_down_{0};

  bool started_ = false;
  std::int64_t epoch_ns_ = 0;
  std::int64_t now_ns_ = 0;
  std::int64_t next_sample_ns_ = 0;
  RigStatistics statistics_;
};

}  // namespace patella::sim
