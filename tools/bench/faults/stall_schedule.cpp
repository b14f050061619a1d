#include "tools/bench/faults/stall_schedule.hpp"

#include <cmath>
#include <cstdint>

#include "firmware_app/loop/lateness.hpp"
#include "tools/bench/faults/scenario.hpp"

namespace patella::bench {
namespace {

// A command from a measurement that a stall has made old is not sent; after the command a stall only
// makes the next tick late.
bool beforeTheCommand(const sim::FaultEvent& stall) {
  return stall.stage && *stall.stage <= tick::Stage::kSend;
}

}  // namespace

std::optional<StallConsequence> stallConsequence(const sim::FaultEvent& stall, const app::RunConfig& config) {
  const double period_s = 1.0 / config.loop.rate_Hz;
  const double margin_s = 2.0 * period_s;
  app::Lateness lateness({.rate_Hz = config.loop.rate_Hz,
                          .overruns_tolerated = config.loop.overruns_tolerated,
                          .stall_tolerated_s = config.loop.stall_tolerated_s,
                          .missed_share_tolerated = config.loop.missed_share_tolerated});
  std::optional<StallConsequence> consequence;
  std::uint32_t missed = 0;
  for (std::int64_t k = 0; static_cast<double>(k) * period_s < kTrialDuration_s; ++k) {
    const double scheduled_s = static_cast<double>(k) * period_s;
    const bool strikes = stall.activeAt(scheduled_s);
    const double end_s = strikes ? stall.burstEnd(scheduled_s) : scheduled_s;
    if (strikes && !consequence) {
      consequence = {scheduled_s, std::nullopt};
    }
    const bool old =
        beforeTheCommand(stall) && end_s - scheduled_s > config.bus.map.encoder_timeout_s + period_s;
    if (lateness.begin(missed) || old) {
      consequence->stop_s = end_s + margin_s;
      return consequence;
    }
    lateness.end(end_s > scheduled_s + period_s);
    const double behind_s = end_s - (scheduled_s + period_s);
    missed = behind_s > 0.0 ? static_cast<std::uint32_t>(std::floor(behind_s / period_s)) : 0U;
    k += missed;
  }
  return consequence;
}

}  // namespace patella::bench
