#include "tools/recordings/time_units.hpp"

#include <array>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "firmware_app/files/file_error.hpp"
#include "tools/recordings/reading_limits.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

using namespace time_units;

struct TimeUnit {
  const char* name;
  double in_s;
};
constexpr std::array kShorter{TimeUnit{"milliseconds, or numbers of samples", 1e-3},
                              TimeUnit{"microseconds", 1e-6}, TimeUnit{"nanoseconds", 1e-9}};
constexpr std::array kLonger{TimeUnit{"minutes", 60.0}, TimeUnit{"hours", 3600.0}, TimeUnit{"days", 86400.0}};

}  // namespace

void requireSeconds(const RawRecording& recording, std::span<const double> stamps_s) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps_s.size(); ++i) {
    steps.push_back(stamps_s[i] - stamps_s[i - 1]);
  }
  const double step_s = offline::median(steps);
  if (step_s < kLongestStep_s && step_s > kShortestStep_s) {
    return;
  }
  std::string look;
  for (const TimeUnit& unit : step_s >= kLongestStep_s ? kShorter : kLonger) {
    const double rate_Hz = 1.0 / (step_s * unit.in_s);
    if (look.empty() && rate_Hz >= kSlowest_Hz && rate_Hz <= kFastest_Hz) {
      look = fmt::format(": looks like {}", unit.name);
    }
  }
  throw app::FileError(fmt::format("{}: {} steps by {:.4g}{}, expected seconds, {} apart", recording.name,
                                   recording.time_name, step_s, look,
                                   step_s >= kLongestStep_s
                                       ? fmt::format("less than {} s", kLongestStep_s)
                                       : fmt::format("more than {} s", kShortestStep_s)));
}

}  // namespace patella::diagnose
