#include <algorithm>
#include <array>
#include <sstream>

#include "core/model/effects/actuator_delay.hpp"
#include "core/model/effects/actuator_lag.hpp"
#include "core/model/effects/asymmetric_friction.hpp"
#include "core/model/effects/backlash.hpp"
#include "core/model/effects/coulomb_friction.hpp"
#include "core/model/effects/emg_torque.hpp"
#include "core/model/effects/encoder_offset.hpp"
#include "core/model/effects/linear_stiffness.hpp"
#include "core/model/effects/load_dependent_friction.hpp"
#include "core/model/effects/passive_knee_moment.hpp"
#include "core/model/effects/payload.hpp"
#include "core/model/effects/presliding_hysteresis.hpp"
#include "core/model/effects/refuse.hpp"
#include "core/model/effects/rotor_inertia.hpp"
#include "core/model/effects/spasticity.hpp"
#include "core/model/effects/stribeck_friction.hpp"
#include "core/model/effects/thermal_drift.hpp"
#include "core/model/effects/torque_bias.hpp"
#include "core/model/effects/torque_gain.hpp"
#include "core/model/effects/torque_ripple.hpp"
#include "core/model/effects/transmission_elasticity.hpp"
#include "core/model/effects/tremor.hpp"
#include "core/model/effects/viscous_friction.hpp"

namespace patella::model {
namespace {

struct Entry {
  const EffectDescriptor* descriptor;
  std::unique_ptr<Effect> (*make)(int joint, const Mechanism& mechanism, std::span<const double> parameters);
};

template <typename Kind>
constexpr Entry entry() {
  return {&Kind::kDescriptor,
          [](int joint, const Mechanism& mechanism, std::span<const double> parameters)
              -> std::unique_ptr<Effect> { return std::make_unique<Kind>(joint, mechanism, parameters); }};
}

// One line per kind, in the order of the documentation.
// clang-format off
constexpr std::array kEntries{
    entry<ViscousFriction>(),
    entry<CoulombFriction>(),
    entry<AsymmetricFriction>(),
    entry<StribeckFriction>(),
    entry<LoadDependentFriction>(),
    entry<PreslidingHysteresis>(),
    entry<LinearStiffness>(),
    entry<PassiveKneeMoment>(),
    entry<Payload>(),
    entry<RotorInertia>(),
    entry<TransmissionElasticity>(),
    entry<Backlash>(),
    entry<TorqueRipple>(),
    entry<TorqueGain>(),
    entry<TorqueBias>(),
    entry<ActuatorLag>(),
    entry<ActuatorDelay>(),
    entry<EncoderOffset>(),
    entry<Tremor>(),
    entry<Spasticity>(),
    entry<EmgTorque>(),
    entry<ThermalDrift>(),
};
// clang-format on

constexpr auto kDescriptors = [] {
  std::array<const EffectDescriptor*, kEntries.size()> descriptors{};
  std::transform(kEntries.begin(), kEntries.end(), descriptors.begin(),
                 [](const Entry& item) { return item.descriptor; });
  return descriptors;
}();

const Entry* findEntry(std::string_view kind) noexcept {
  const auto* found = std::find_if(kEntries.begin(), kEntries.end(),
                                   [kind](const Entry& item) { return item.descriptor->kind == kind; });
  return found == kEntries.end() ? nullptr : found;
}

[[noreturn]] void refuseKind(std::string_view kind) {
  std::ostringstream known;
  for (const EffectDescriptor* descriptor : kDescriptors) {
    known << (descriptor == kDescriptors.front() ? "" : ", ") << descriptor->kind;
  }
  refuse("effect kind '", kind, "' is unknown, expected one of ", known.str());
}

}  // namespace

std::span<const EffectDescriptor* const> effectCatalogue() noexcept {
  return kDescriptors;
}

const EffectDescriptor* findEffect(std::string_view kind) noexcept {
  const Entry* found = findEntry(kind);
  return found == nullptr ? nullptr : found->descriptor;
}

std::unique_ptr<Effect> makeEffect(std::string_view kind, int joint, const Mechanism& mechanism,
                                   std::span<const double> parameters) {
  const Entry* found = findEntry(kind);
  if (found == nullptr) {
    refuseKind(kind);
  }
  if (joint < 0 || joint >= mechanism.joints()) {
    refuse("effect ", kind, ": joint is ", joint, ", expected 0 to ", mechanism.joints() - 1);
  }
  const std::span<const EffectParameter> expected = found->descriptor->parameters;
  if (parameters.size() != expected.size()) {
    refuse("effect ", kind, ": ", parameters.size(), " parameters given, expected ", expected.size());
  }
  for (std::size_t i = 0; i < expected.size(); ++i) {
    // Written so that NaN is refused.
    if (!(parameters[i] >= expected[i].minimum && parameters[i] <= expected[i].maximum)) {
      refuse("effect ", kind, ": ", expected[i].name, " is ", parameters[i], ", expected ",
             expected[i].minimum, " to ", expected[i].maximum);
    }
  }
  return found->make(joint, mechanism, parameters);
}

}  // namespace patella::model
