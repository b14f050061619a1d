#include "sim/rig.hpp"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <utility>

#include "drivers/can/error_monitor.hpp"

namespace patella::sim {
namespace {

constexpr double kResetPress_s = 0.1;

std::unique_ptr<model::Mechanism> makeMechanism(const model::PlanarTwoLinkParameters& parameters) {
  return std::make_unique<model::PlanarTwoLink>(parameters);
}
std::unique_ptr<model::Mechanism> makeMechanism(const model::RevoluteJointParameters& parameters) {
  return std::make_unique<model::RevoluteJoint>(parameters);
}
std::unique_ptr<model::Mechanism> makeMechanism(const model::PrismaticJointParameters& parameters) {
  return std::make_unique<model::PrismaticJoint>(parameters);
}

model::DynamicsModel makeModel(const MechanismParameters& parameters,
                               std::initializer_list<const std::vector<EffectOptions>*> groups) {
  std::unique_ptr<model::Mechanism> mechanism =
      std::visit([](const auto& p) { return makeMechanism(p); }, parameters);
  std::vector<std::unique_ptr<model::Effect>> effects;
  for (const auto* group : groups) {
    for (const EffectOptions& e : *group) {
      effects.push_back(model::makeEffect(e.kind, e.joint, *mechanism, e.parameters));
    }
  }
  return {std::move(mechanism), std::move(effects)};
}

JointVector jointVector(const std::vector<double>& values, int joints, const char* name) {
  if (values.empty()) {
    return JointVector::Zero(joints);
  }
  if (values.size() != static_cast<std::size_t>(joints)) {
    throw std::invalid_argument(std::string("rig ") + name + " has " + std::to_string(values.size()) +
                                " values, expected one for each of " + std::to_string(joints) + " joints");
  }
  return Eigen::Map<const Eigen::VectorXd>(values.data(), joints);
}

Plant makePlant(const RigOptions& options, model::DynamicsModel truth, model::DynamicsModel known) {
  const int joints = truth.joints();
  const PlantState initial{jointVector(options.initial_q_rad, joints, "initial_q_rad"),
                           jointVector(options.initial_dq_rad_s, joints, "initial_dq_rad_s")};
  return {std::move(truth), std::move(known), options.interaction, options.seed, initial, options.max_step_s};
}

std::vector<Encoder> makeEncoders(const RigOptions& options, int joints) {
  std::vector<Encoder> encoders;
  for (int joint = 0; joint < joints; ++joint) {
    encoders.emplace_back(options.encoder, joint, options.seed);
  }
  return encoders;
}

const std::vector<FieldDriveOptions>& checkedDrives(const RigOptions& options, int joints) {
  if (!options.field_drives.empty() && options.field_drives.size() != static_cast<std::size_t>(joints)) {
    throw std::invalid_argument("rig has " + std::to_string(options.field_drives.size()) +
                                " drive models, expected none or one for each of " + std::to_string(joints) +
                                " joints");
  }
  for (const FaultEvent& event : options.faults) {
    if (needsFieldDrive(event.kind) && options.field_drives.empty()) {
      throw std::invalid_argument("fault '" + std::string(faultKindName(event.kind)) +
                                  "' needs drives that are nodes of their own, expected rig.drive_model");
    }
    const bool canopen =
        std::any_of(options.field_drives.begin(), options.field_drives.end(),
                    [](const FieldDriveOptions& drive) { return drive.kind == FieldDriveKind::kCia402; });
    if (needsCanopenDrive(event.kind) && !canopen) {
      throw std::invalid_argument("fault '" + std::string(faultKindName(event.kind)) +
                                  "' needs a CANopen drive, expected a rig.drive_model of kind cia402");
    }
  }
  return options.field_drives;
}

bool anySlow(const RigOptions& options) {
  return options.drive.bandwidth_Hz > 0.0 ||
         std::any_of(options.field_drives.begin(), options.field_drives.end(),
                     [](const FieldDriveOptions& drive) { return drive.bandwidth_Hz > 0.0; });
}

std::int64_t checkedPeriod(const RigOptions& options) {
  if (options.sensor_period_ns <= 0) {
    throw std::invalid_argument("rig sensor_period_ns is " + std::to_string(options.sensor_period_ns) +
                                ", expected > 0");
  }
  if (options.operator_period_ns <= 0 || options.operator_period_ns % options.sensor_period_ns != 0) {
    throw std::invalid_argument("rig operator_period_ns is " + std::to_string(options.operator_period_ns) +
                                ", expected a multiple of sensor_period_ns");
  }
  return options.sensor_period_ns;
}

}  // namespace

Rig::Rig(const RigOptions& options, const can::Database& database)
    : Rig(options, makeModel(options.mechanism, {&options.known_effects, &options.hidden_effects}),
          makeModel(options.known_mechanism.value_or(options.mechanism), {&options.known_effects}),
          database) {}

Rig::Rig(const RigOptions& options, model::DynamicsModel truth, model::DynamicsModel known,
         const can::Database& database)
    : buses_(options.buses),
      sensor_period_ns_(checkedPeriod(options)),
      samples_per_operator_frame_(
          static_cast<std::uint64_t>(options.operator_period_ns / options.sensor_period_ns)),
      max_step_s_(options.max_step_s),
      slow_drive_(anySlow(options)),
      publish_truth_(options.publish_truth),
      operator_(options.operator_buttons),
      plant_(makePlant(options, std::move(truth), std::move(known))),
      drive_(options.drive, plant_.joints(), options.seed),
      field_drives_(checkedDrives(options, plant_.joints())),
      emg_(options.emg, 1e9 / static_cast<double>(options.sensor_period_ns), plant_.joints(), options.seed),
      recorded_emg_(options.emg_log.empty()
                        ? std::nullopt
                        : std::optional<RecordedEmg>(std::in_place, options.emg_log, database)),
      encoders_(makeEncoders(options, plant_.joints())),
      messages_(database, plant_.joints(), field_drives_.any()),
      queue_(options.queue_frames),
      faults_(options.faults, database, options.seed) {}

void Rig::advance(std::int64_t to_ns) noexcept PATELLA_NONBLOCKING {
  if (!started_) {
    start(to_ns);
    return;
  }
  while (now_ns_ < to_ns) {
    integrateTo(std::min({to_ns, next_sample_ns_, drive_.deadline_ns(), field_drives_.deadline_ns()}));
    drive_.watch(now_ns_);
    field_drives_.watch(now_ns_);
    if (now_ns_ == next_sample_ns_) {
      sample();
      next_sample_ns_ += sensor_period_ns_;
    }
  }
}

void Rig::accept(const can::Frame& frame) noexcept PATELLA_NONBLOCKING {
  if (frame.own || (!field_drives_.any() && !messages_.isCommand(frame))) {
    return;
  }
  faults_.pass(frame, FrameChannel::kCommand, [this](const can::Frame& command) { obey(command); });
}

JointReading Rig::read(std::size_t joint) noexcept {
  const auto i = static_cast<Eigen::Index>(joint);
  // One after the other: the order of arguments is the compiler's, and both draw from one random sequence.
  JointReading reading;
  reading.velocity_rad_s = encoders_[joint].measureVelocity(plant_.state().dq(i));
  reading.position_rad = encoders_[joint].measurePosition(plant_.state().q(i));
  faults_.encoder(static_cast<int>(joint), reading.position_rad, reading.velocity_rad_s);
  return reading;
}

void Rig::obey(const can::Frame& frame) noexcept {
  if (field_drives_.any()) {
    bool taken = false;
    for (std::size_t joint = 0; joint < field_drives_.size(); ++joint) {
      DriveSink sink(*this, field_drives_[joint].options().bus);
      taken = field_drives_[joint].accept(frame, read(joint), now_ns_, sink) || taken;
    }
    ++(taken ? statistics_.commands_accepted : statistics_.commands_rejected);
    return;
  }
  JointVector torque_Nm(plant_.joints());
  bool enable = false;
  if (!messages_.decodeCommand(frame, torque_Nm, enable)) {
    ++statistics_.commands_rejected;
    return;
  }
  ++statistics_.commands_accepted;
  drive_.command(torque_Nm, enable, now_ns_);
}

RigStatistics Rig::statistics() const noexcept {
  RigStatistics statistics = statistics_;
  statistics.watchdog_trips = drive_.watchdogTrips() + field_drives_.watchdogTrips();
  return statistics;
}

void Rig::start(std::int64_t now_ns) noexcept {
  started_ = true;
  epoch_ns_ = now_ns;
  now_ns_ = now_ns;
  next_sample_ns_ = now_ns + sensor_period_ns_;
  sample();
}

void Rig::integrateTo(std::int64_t instant_ns) noexcept {
  const double duration_s = static_cast<double>(instant_ns - now_ns_) * 1e-9;
  now_ns_ = instant_ns;
  const int steps = slow_drive_ ? static_cast<int>(std::ceil(duration_s / max_step_s_ - 1e-9)) : 1;
  const double h = duration_s / steps;
  for (int i = 0; i < steps; ++i) {
    // A torque that moves is held at its value in the middle of each step.
    drive_.advance(0.5 * h);
    field_drives_.advance(0.5 * h);
    plant_.advance(torque(), emg_.activation(), h);
    drive_.advance(0.5 * h);
    field_drives_.advance(0.5 * h);
    statistics_.max_torque_Nm = std::max(statistics_.max_torque_Nm, torque().lpNorm<Eigen::Infinity>());
  }
}

void Rig::sample() noexcept {
  const double time_s = static_cast<double>(now_ns_ - epoch_ns_) * 1e-9;
  sampleFaults(time_s);
  faults_.release([this](const can::Frame& frame, FrameChannel channel) {
    if (channel == FrameChannel::kCommand) {
      obey(frame);
    } else {
      queue(frame);
    }
  });
  sampleDrives();
  emg_.advance(time_s, plant_.state().dq);
  EmgArray emg_mV = recorded_emg_ ? recorded_emg_->at(now_ns_ - epoch_ns_) : emg_.signal();
  faults_.emg(emg_mV);
  if (messages_.hasEmg()) {
    send(messages_.emg(emg_mV), FrameChannel::kEmg);
  }
  const JointVector unknown = plant_.takeMeanUnknownDynamics();
  for (std::size_t i = 0; publish_truth_ && i < messages_.truthFrames(); ++i) {
    send(messages_.truth(i, unknown), FrameChannel::kTruth);
  }
  if (statistics_.samples % samples_per_operator_frame_ == 0) {
    send(messages_.operatorButtons(time_s >= operator_.enable_at_s, resetPressed(time_s)),
         FrameChannel::kOperator);
  }
  // A bus is heard by everybody, commands of another sender included.
  faults_.forge([this](const can::Frame& frame, FrameChannel channel) {
    if (channel == FrameChannel::kCommand) {
      obey(frame);
    }
    queue(frame);
  });
  ++statistics_.samples;
}

void Rig::sampleDrives() noexcept {
  if (field_drives_.any()) {
    for (std::size_t joint = 0; joint < field_drives_.size(); ++joint) {
      DriveSink sink(*this, field_drives_[joint].options().bus);
      field_drives_[joint].sample(read(joint), now_ns_, sink);
    }
    return;
  }
  for (std::size_t joint = 0; joint < encoders_.size(); ++joint) {
    const JointReading reading = read(joint);
    send(messages_.encoder(joint, reading.position_rad, reading.velocity_rad_s),
         joint == 0 ? FrameChannel::kEncoder1 : FrameChannel::kEncoder2);
  }
  send(messages_.driveStatus(drive_.reportedTorque(), drive_.enabled(), drive_.fault()),
       FrameChannel::kDriveStatus);
}

void Rig::sampleFaults(double time_s) noexcept {
  if (faults_.events().empty()) {
    return;
  }
  faults_.advance(time_s);
  drive_.disturb(faults_.drive());
  for (std::size_t joint = 0; joint < field_drives_.size(); ++joint) {
    field_drives_[joint].defect(faults_.fieldDrive(static_cast<int>(joint)), now_ns_);
  }
  interfaces_down_.store(faults_.struck(FaultKind::kInterfaceDown), std::memory_order_relaxed);
  reportError(can::kErrorBusOff, faults_.beganOn(FaultKind::kBusOff));
  reportError(can::kErrorRestarted, faults_.endedOn(FaultKind::kBusOff));
  if (faults_.began(FaultKind::kPeerRestart)) {
    drive_.restart();
  }
  if (faults_.ended(FaultKind::kPeerRestart)) {
    messages_.restart();
  }
}

void Rig::reportError(std::uint32_t error_class, can::BusSet buses) noexcept {
  for (std::size_t bus = 0; bus < buses_; ++bus) {
    if ((buses & can::busBit(bus)) == 0) {
      continue;
    }
    can::Frame report;
    report.error = true;
    report.id = error_class;
    report.length = 8;
    report.bus = static_cast<std::uint8_t>(bus);
    queue(report);
  }
}

void Rig::send(const can::Frame& frame, FrameChannel channel) noexcept {
  faults_.pass(frame, channel, [this](const can::Frame& left) { queue(left); });
}

void Rig::queue(can::Frame frame) noexcept {
  frame.monotonic_ns = now_ns_;
  frame.wall_ns = now_ns_ + wallStep_ns();
  statistics_.frames_dropped += queue_.push(frame) ? 0U : 1U;
}

bool Rig::resetPressed(double time_s) const noexcept {
  return std::any_of(operator_.reset_at_s.begin(), operator_.reset_at_s.end(), [time_s](double start_s) {
    return time_s >= start_s && time_s < start_s + kResetPress_s;
  });
}

}  // namespace patella::sim
