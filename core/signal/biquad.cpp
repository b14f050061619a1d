#include "core/signal/biquad.hpp"

#include "core/check.hpp"

namespace patella::signal {

void BiquadCascade::append(const BiquadCoefficients& section) {
  requireRange("number of filter sections", count_ + 1, 1, kMaxSections);
  sections_[static_cast<std::size_t>(count_)] = Biquad(section);
  ++count_;
}

void BiquadCascade::append(const BiquadCascade& other) {
  for (const Biquad& section : other.sections()) {
    append(section.coefficients());
  }
}

}  // namespace patella::signal
