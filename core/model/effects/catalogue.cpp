#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>

#include "core/model/effects/coulomb_friction.hpp"
#include "core/model/effects/linear_stiffness.hpp"
#include "core/model/effects/payload.hpp"
#include "core/model/effects/rotor_inertia.hpp"
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

constexpr std::array kEntries{
    entry<ViscousFriction>(), entry<CoulombFriction>(), entry<LinearStiffness>(),
    entry<Payload>(),         entry<RotorInertia>(),
};

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

template <typename... Parts>
[[noreturn]] void refuse(const Parts&... parts) {
  std::ostringstream message;
  (message << ... << parts);
  throw std::invalid_argument(message.str());
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
