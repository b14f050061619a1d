#include "core/model/effects/torque_gain.hpp"

namespace patella::model {
namespace {

constexpr std::array kParameters{
    EffectParameter{"gain_error", "share of the torque that is given in excess", -0.5, 0.5, 0.05}};

}  // namespace

constinit const EffectDescriptor TorqueGain::kDescriptor{
    "torque_gain", "tau = gain_error * drive torque",
    "Gautier, Briot 2014, Journal of Dynamic Systems, Measurement and Control 136(5)", kParameters};

TorqueGain::TorqueGain(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector TorqueGain::torque(const EffectInput& input) const noexcept {
  return onJoint(parameter(0) * input.torque_Nm[joint()], input.q.size());
}

}  // namespace patella::model
