#include "core/model/effects/emg_torque.hpp"

#include <cmath>

#include "core/model/effects/refuse.hpp"

namespace patella::model {
namespace {

// At full activation a knee extensor gives up to 250 N·m. Electromechanical delay: 20 to 100 ms.
constexpr std::array kParameters{
    EffectParameter{"gain_Nm", "torque at full activation", -300.0, 300.0, 5.0},
    EffectParameter{"channel", "EMG channel, a whole number", 1.0, kMaxEmgChannels, 1.0, false},
    EffectParameter{"delay_s", "from activation to torque", 0.0, 0.15, 0.04}};

}  // namespace

constinit const EffectDescriptor EmgTorque::kDescriptor{
    "emg_torque", "tau = gain * activation[channel](t - delay)",
    "Buchanan, Lloyd, Manal, Besier 2004, Journal of Applied Biomechanics 20(4)", kParameters};

EmgTorque::EmgTorque(int joint, const Mechanism& /*mechanism*/, std::span<const double> parameters)
    : JointEffect(joint, parameters), channel_(static_cast<std::size_t>(parameter(1)) - 1) {
  if (parameter(1) != std::floor(parameter(1))) {
    refuse("effect emg_torque: channel is ", parameter(1), ", expected a whole number");
  }
}

JointVector EmgTorque::torque(const EffectInput& input) const noexcept {
  return onJoint(parameter(0) * activation_.at(parameter(2), time_.elapsed_s(input), activation(input)),
                 input.q.size());
}

void EmgTorque::advance(const EffectInput& input, double dt_s) noexcept {
  activation_.push(activation(input), dt_s);
  time_.set(input);
}

void EmgTorque::reset(const EffectInput& input) noexcept {
  activation_.reset(activation(input));
  time_.set(input);
}

}  // namespace patella::model
