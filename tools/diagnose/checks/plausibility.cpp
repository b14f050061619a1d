#include "tools/diagnose/checks/plausibility.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include <fmt/format.h>

#include "tools/diagnose/checks/convention_search.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/motion_band.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/recordings/reading_limits.hpp"

namespace patella::diagnose {
namespace {

// What a file may hold is refused once, as it is read.
static_assert(readable::kFewestRows == kFewestRows && readable::kFewestPostures == kFewestPostures);

[[noreturn]] void refuse(const Recording& recording, const std::string& reason) {
  throw std::invalid_argument(recording.name + ": " + reason);
}

void requireFinite(const Recording& recording, const std::string& name, const std::vector<double>& values,
                   bool optional) {
  if (optional && values.empty()) {
    return;
  }
  if (values.size() != recording.rows()) {
    refuse(recording,
           fmt::format("{} has {} values, expected {}, one a row", name, values.size(), recording.rows()));
  }
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      refuse(recording, fmt::format("{} is {} at {:.4g} s, expected a finite number", name, values[i],
                                    recording.time_s[i]));
    }
  }
}

void requireSegments(const Recording& recording) {
  if (recording.segments.empty()) {
    refuse(recording, "there is no stretch of rows, expected at least one");
  }
  for (const Segment& segment : recording.segments) {
    if (segment.first >= segment.end || segment.end > recording.rows()) {
      refuse(recording, fmt::format("a stretch from row {} to {}, expected it within 0 to {}", segment.first,
                                    segment.end, recording.rows()));
    }
    for (std::size_t i = segment.first + 1; i < segment.end && !recording.is_static; ++i) {
      if (!(recording.time_s[i] > recording.time_s[i - 1])) {
        refuse(recording, fmt::format("time {:.6g} s comes after {:.6g} s, expected it to increase",
                                      recording.time_s[i], recording.time_s[i - 1]));
      }
    }
  }
}

// What was lost as the file was read may be why it is too short, and no report will tell it.
std::string warningOf(const Recording& recording) {
  return recording.warnings.empty() ? "" : "; " + recording.warnings.front();
}

void requireLength(const Recording& recording) {
  if (recording.is_static) {
    if (recording.rows() < readable::kFewestPostures) {
      refuse(recording,
             fmt::format("{} postures, expected at least {}", recording.rows(), readable::kFewestPostures));
    }
    return;
  }
  if (!(recording.rate_Hz > 0.0) || !std::isfinite(recording.rate_Hz)) {
    refuse(recording, fmt::format("rate {} Hz, expected a positive one", recording.rate_Hz));
  }
  if (recording.rows() < readable::kFewestRows) {
    refuse(recording, fmt::format("{} rows, expected at least {}{}", recording.rows(), readable::kFewestRows,
                                  warningOf(recording)));
  }
  double longest_s = 0.0;
  for (const Segment& segment : recording.segments) {
    longest_s = std::max(longest_s, static_cast<double>(segment.end - segment.first) / recording.rate_Hz);
  }
  if (longest_s < readable::kShortest_s) {
    refuse(recording,
           fmt::format("its longest stretch without a gap takes {:.3g} s, expected at least {:.3g} s{}",
                       longest_s, readable::kShortest_s, warningOf(recording)));
  }
}

void requireSignals(const Recording& recording, const model::ModelDescription& model) {
  if (recording.joints != model.joints()) {
    refuse(recording,
           fmt::format("it has {} joints, expected {} as the model has", recording.joints, model.joints()));
  }
  requireFinite(recording, "time", recording.time_s, false);
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    requireFinite(recording, fmt::format("position of joint {}", j + 1), recording.position_rad[j], false);
    requireFinite(recording, fmt::format("torque of joint {}", j + 1), recording.torque_Nm[j], false);
    requireFinite(recording, fmt::format("commanded torque of joint {}", j + 1), recording.commanded_Nm[j],
                  true);
  }
  for (std::size_t c = 0; c < recording.activation.size(); ++c) {
    requireFinite(recording, fmt::format("activation {}", c + 1), recording.activation[c], true);
  }
  requireSegments(recording);
  requireLength(recording);
}

// The band that the motion takes, as far as differences between samples tell it.
void requireRate(const Recording& recording) {
  const double needed_Hz = motionBand_Hz(std::span(&recording, 1)) / readable::kBandShareOfRate;
  if (recording.rate_Hz < needed_Hz) {
    refuse(recording,
           fmt::format("sampled at {:.3g} Hz, which is too slow for accelerations; at least {:.0f} Hz are "
                       "needed for this motion; or is time not in seconds?",
                       recording.rate_Hz, std::ceil(needed_Hz)));
  }
}

}  // namespace

void requirePlausible(std::span<const Recording> recordings, const model::ModelDescription& model) {
  for (const Recording& recording : recordings) {
    requireSignals(recording, model);
    if (!recording.is_static) {
      requireRate(recording);
    }
    requireAngles(recording, model);
    // At rest a model may explain next to nothing: what is measured there are effects.
    if (!recording.is_static) {
      requireConventions(recording, model);
    }
  }
}

}  // namespace patella::diagnose
