// The time axis of a foreign recording: cleaned of repeated stamps, and brought to a uniform grid.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

namespace patella::convert {

/// How values between two samples are found.
enum class Interpolation { kHold, kLinear, kCubic };

/// "hold", "linear", "cubic", in the order of the enumeration.
const std::vector<std::string>& interpolationNames();

struct TimeBase {
  std::vector<double> time_s;       ///< strictly increasing
  std::vector<std::size_t> row;     ///< of the recording, for each instant
  std::size_t repeated = 0;         ///< rows left out because the next one has the same stamp
  double longest_gap_s = 0.0;       ///< between neighbouring instants
  std::size_t longest_gap_row = 0;  ///< row at its end
};

/// The last of several rows with the same stamp is kept. Throws std::invalid_argument "<row> ..." when time
/// goes back.
TimeBase cleanTime(std::span<const double> stamps_s);

/// First instant, then one each 1/rate_Hz, up to the last.
std::vector<double> uniformGrid(const TimeBase& base, double rate_Hz);

/// Values of the rows of `base` at the instants of `grid`, which must increase and lie within the base. Cubic
/// is the Hermite spline with three-point slopes: passes through every sample, and needs no more than
/// the neighbours.
std::vector<double> resample(const TimeBase& base, std::span<const double> values,
                             std::span<const double> grid, Interpolation method);

}  // namespace patella::convert
