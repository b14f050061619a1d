// The methods that are compared, each with the numbers that may be tuned.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/estimation/kalman_settings.hpp"
#include "core/estimation/observer.hpp"
#include "tools/studies/observers/condition.hpp"

namespace patella::study {

/// A positive number of a method, searched on a logarithmic grid from `start`.
struct Tunable {
  std::string name;  ///< with unit
  double start = 1.0;
};

struct Method {
  enum class Kind : std::uint8_t {
    kCausal,
    kDelayed,  ///< gives the estimate of an earlier sample
    kOffline,  ///< sees the whole recording
  };

  std::string name;
  Kind kind = Kind::kCausal;
  std::vector<Tunable> tunables;
  /// Reads only ObserverInput::dq for motion: where velocity is not measured it is derived from position by
  /// a filter whose cutoff is then tuned, too.
  bool needs_velocity = true;
  bool takes_encoder_only = true;
  int lag_steps = 0;  ///< kDelayed: by which the estimate is older than the sample
  std::function<std::unique_ptr<estimation::Observer>(const Condition&, std::span<const double>)> make{};
  /// kOffline: the settings of the smoother.
  std::function<estimation::KalmanSettings(const Condition&, std::span<const double>)> settings{};
};

const std::vector<Method>& methods();

/// Those of a method in a condition, the velocity's cutoff last where there is one.
std::vector<Tunable> tunablesOf(const Method& method, const Condition& condition);

}  // namespace patella::study
