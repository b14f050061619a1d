// Set-up of a MeasurementDecoder, which may throw. What the loop calls is in measurement_decoder.cpp.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "drivers/can/binding_check.hpp"
#include "drivers/can/measurement_decoder.hpp"

namespace patella::can {
namespace {

constexpr double kNanosecondsPerSecond = 1e9;

std::int64_t toNanoseconds(const Bound& bound, double seconds) {
  requireBound(bound, seconds);
  return static_cast<std::int64_t>(std::llround(seconds * kNanosecondsPerSecond));
}

}  // namespace

MeasurementDecoder::MeasurementDecoder(const Database& database, const BusMap& map, int joints)
    : joints_(joints),
      indices_(static_cast<std::size_t>(std::max(joints, kMaxEmgChannels))),
      position_min_rad_(map.position_min_rad),
      position_max_rad_(map.position_max_rad),
      position_jump_rad_(map.position_jump_rad),
      tolerated_(map.tolerated_bad_frames) {
  if (joints < 1 || joints > kMaxJoints) {
    throw std::invalid_argument("number of joints is " + std::to_string(joints) + ", expected 1 to " +
                                std::to_string(kMaxJoints));
  }
  timeouts_ns_ = {toNanoseconds(boundOf("checks.encoder_timeout_s"), map.encoder_timeout_s),
                  toNanoseconds(boundOf("checks.drive_timeout_s"), map.drive_timeout_s),
                  toNanoseconds(boundOf("checks.emg_timeout_s"), map.emg_timeout_s),
                  toNanoseconds(boundOf("checks.operator_timeout_s"), map.operator_timeout_s),
                  std::numeric_limits<std::int64_t>::max()};
  requireBound(boundOf("checks.encoder_period_s"), map.encoder_period_s);
  requireBound(boundOf("checks.emg_period_s"), map.emg_period_s);
  requireBound(boundOf("checks.position_min_rad"), position_min_rad_);
  requireBound(boundOf("checks.position_max_rad"), position_max_rad_);
  requireBound(boundOf("checks.position_jump_rad"), position_jump_rad_);
  requireBound(boundOf("checks.tolerated_bad_frames"), tolerated_);
  if (!(position_min_rad_ < position_max_rad_)) {
    throw std::invalid_argument(
        "checks.position_min_rad = " + std::to_string(position_min_rad_) +
        ", expected less than checks.position_max_rad = " + std::to_string(position_max_rad_));
  }
  for (const Protection& protection : map.protections) {
    CompiledMessage(database.message(protection.message), protection);
  }
  checkBindings(database, map, {});
  for (const Binding& binding : map.bindings)
    bind(database, map, binding);

  for (int joint = 0; joint < joints_; ++joint) {
    if (!isBound(Input::kPosition, static_cast<std::size_t>(joint))) {
      throw std::invalid_argument("no signal is bound to input 'position_rad." + std::to_string(joint + 1) +
                                  "'");
    }
  }
  requireAllOrNone(Input::kVelocity);
  requireAllOrNone(Input::kDriveTorque);
  requireAllOrNone(Input::kTruth);
  for (JointVector* vector : {&measurement_.position_rad, &measurement_.velocity_rad_s,
                              &measurement_.drive_torque_Nm, &measurement_.lowest_drive_torque_Nm,
                              &measurement_.highest_drive_torque_Nm, &measurement_.true_f_u}) {
    vector->setZero(joints_);
  }
  measurement_.has_velocity = isBound(Input::kVelocity);
  measurement_.has_drive_torque = isBound(Input::kDriveTorque);
  requireOneForm(Input::kDriveEnabled, Input::kJointEnabled);
  requireOneForm(Input::kDriveFault, Input::kJointFault);
  for (std::size_t joint = 0; joint < static_cast<std::size_t>(joints_); ++joint) {
    measurement_.drive_enabled[joint].bound =
        isBound(Input::kDriveEnabled) || isBound(Input::kJointEnabled, joint);
  }
}

InputId MeasurementDecoder::inputIn(const Binding& binding, int joints) {
  try {
    return inputOf(binding.input, joints);
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument((binding.origin.empty() ? "" : binding.origin + ": ") + error.what());
  }
}

MeasurementDecoder::BoundMessage& MeasurementDecoder::boundMessage(const Database& database,
                                                                   const BusMap& map,
                                                                   const std::string& name) {
  const auto bound = std::find_if(messages_.begin(), messages_.end(), [&](const BoundMessage& candidate) {
    return candidate.decoder.layout().name() == name;
  });
  if (bound != messages_.end())
    return *bound;
  const auto protection =
      std::find_if(map.protections.begin(), map.protections.end(),
                   [&](const Protection& candidate) { return candidate.message == name; });
  return messages_.emplace_back(MessageDecoder(
      database.message(name), protection == map.protections.end() ? Protection{} : *protection));
}

void MeasurementDecoder::bind(const Database& database, const BusMap& map, const Binding& binding) {
  const std::string quoted = "input '" + binding.input + "'";
  const InputId id = inputIn(binding, joints_);
  const auto [input, index] = id;
  const InputGroup group = id.kind().group;
  requireBound(boundOf("input.scale"), binding.scale, quoted + ": scale");
  requireBound(boundOf("input.offset"), binding.offset, quoted + ": offset");
  bound_[static_cast<std::size_t>(input)][index] = true;

  try {
    BoundMessage& message = boundMessage(database, map, binding.message);
    buses_[static_cast<std::size_t>(input)][index] = message.decoder.layout().bus();
    message.inputs.push_back({input, static_cast<std::uint8_t>(index), message.decoder.slot(binding.signal),
                              binding.scale, binding.offset, binding.good, binding.mask});
    message.groups[group] = true;
    message.timeout_ns = std::min(message.timeout_ns, timeouts_ns_[group]);
    const bool emg_only = input == Input::kEmg && message.period_ns == 0;
    if (emg_only || input == Input::kPosition) {
      message.period_ns = emg_only ? toNanoseconds(boundOf("checks.emg_period_s"), map.emg_period_s)
                                   : toNanoseconds(boundOf("checks.encoder_period_s"), map.encoder_period_s);
    }
  } catch (const std::invalid_argument& error) {
    throw std::invalid_argument(quoted + ": " + error.what());
  }
  if (input == Input::kPosition)
    encoder_samples_.bind(index);
  if (input == Input::kEmg)
    emg_samples_.bind(index);
}

void MeasurementDecoder::requireAllOrNone(Input input) const {
  const auto& bound = bound_[static_cast<std::size_t>(input)];
  const auto count = std::count(bound.begin(), bound.begin() + joints_, true);
  if (count != 0 && count != joints_) {
    throw std::invalid_argument("input '" + std::string(kInputKinds[static_cast<std::size_t>(input)].name) +
                                "' is bound for some joints and not for others; expected all or none");
  }
}

void MeasurementDecoder::requireOneForm(Input all, Input one) const {
  const auto& bound = bound_[static_cast<std::size_t>(one)];
  if (isBound(all) && std::find(bound.begin(), bound.end(), true) != bound.end()) {
    const std::string name(kInputKinds[static_cast<std::size_t>(all)].name);
    throw std::invalid_argument("input '" + name + "' is bound for all drives and for a joint's, expected '" +
                                name + "' alone or '" + name + ".<number>' for each");
  }
}

}  // namespace patella::can
