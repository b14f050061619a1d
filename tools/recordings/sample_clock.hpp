// The clock behind jittered time stamps.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace patella::diagnose {

/// Counts the periods of a clock of about `rate_Hz` that passed up to each stamp, the first at 0, lost
/// samples counted. Stamps are those of arrival, so that each may be off by almost half a period; the clock
/// itself may run a little fast or slow. `stamps_s` must increase. Nothing where no such clock explains them.
std::optional<std::vector<std::size_t>> clockTicks(std::span<const double> stamps_s, double rate_Hz);

}  // namespace patella::diagnose
