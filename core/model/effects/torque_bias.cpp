#include "core/model/effects/torque_bias.hpp"

namespace patella::model {
namespace {

// Knee robots: within 1 N·m. The range leaves room for linear axes (N).
constexpr std::array kParameters{
    EffectParameter{"bias_Nm", "torque in addition to the drive's", -200.0, 200.0, 0.3}};

}  // namespace

constinit const EffectDescriptor TorqueBias::kDescriptor{
    "torque_bias", "tau = bias",
    "Janot, Gautier, Brunot 2019, Workshop on Nonlinear System Identification Benchmarks (EMPS)",
    kParameters};

TorqueBias::TorqueBias(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters) {}

JointVector TorqueBias::torque(const EffectInput& input) const noexcept {
  return onJoint(parameter(0), input.q.size());
}

}  // namespace patella::model
