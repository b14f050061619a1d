// Which observer the loop runs, and with which numbers: the table [estimation].
#pragma once

#include <memory>
#include <string_view>

#include "core/estimation/kalman_settings.hpp"
#include "core/estimation/momentum_observer.hpp"
#include "core/estimation/observer.hpp"
#include "core/estimation/sampler_parameters.hpp"
#include "core/estimation/super_twisting_observer.hpp"
#include "core/estimation/terminal_sliding_observer.hpp"
#include "core/tick/tick.hpp"
#include "firmware_app/files/toml_table.hpp"

namespace patella::app {

enum class ObserverKind {
  kImplicitSampler,
  kPrintedSampler,
  kTerminalSliding,
  kMomentum,
  kExtendedState,
  kSuperTwisting,
  kKalmanTorque,
  kKalmanForce
};

/// As written in the configuration: implicit_sampler, …, kalman_force.
std::string_view observerName(ObserverKind kind) noexcept;

/// Only the settings of `kind` are used.
struct ObserverConfig {
  ObserverKind kind = ObserverKind::kImplicitSampler;
  estimation::SamplerParameters sampler;
  estimation::TerminalSlidingParameters terminal_sliding;
  estimation::MomentumParameters momentum;
  PerJoint extended_state_bandwidth_Hz{};
  estimation::SuperTwistingParameters super_twisting;
  estimation::KalmanSettings kalman;
};

/// Reads [estimation]: the observer, only the keys that belong to it, and what the tick does with its
/// estimate. Throws FileError.
ObserverConfig readEstimation(const TomlTable& table, int joints, tick::TickSettings& tick);

/// Throws std::invalid_argument naming the setting, its value and what was expected.
std::unique_ptr<estimation::Observer> makeObserver(const ObserverConfig& config, int joints);

}  // namespace patella::app
