// A physical effect beyond the rigid body: friction, stiffness, payload, actuation. One implementation of
// each serves the loop, the simulation and the diagnosis.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "core/model/mechanism.hpp"
#include "core/types.hpp"

namespace patella::model {

/// Inputs of an effect. All vectors have the mechanism's number of joints.
struct EffectInput {
  JointVector q;          ///< rad
  JointVector dq;         ///< rad/s
  JointVector torque_Nm;  ///< of the drives, N·m
  EmgArray activation{};  ///< 0…1 per EMG channel
  double time_s = 0.0;    ///< of the caller's clock, not decreasing
  /// The torque was held at torque_Nm over the step that ends here, as commands are in simulation; otherwise
  /// it went there in a straight line, which suits sampled torques, and terms averaged over the ends of a
  /// step.
  bool torque_held = false;
};

/// A parameter of an effect: its name carries its unit, its range is the physical one, bounds included.
struct EffectParameter {
  std::string_view name;
  std::string_view meaning;
  double minimum;
  double maximum;
  double initial;
  bool identified = true;  ///< false for a modelling choice that no recording determines: kept as given
};

/// Description of a kind of effect, without an instance.
struct EffectDescriptor {
  std::string_view kind;      ///< the name in model files
  std::string_view equation;  ///< plain text
  std::string_view source;    ///< literature
  std::span<const EffectParameter> parameters;
  /// The torque is what arrives of the drive's torque, less that torque: a lag, a delay, a motor behind a
  /// spring. A command that balanced it would be fed back to itself and ring.
  bool of_drive = false;
  /// inertia() may be other than zero. Without one, the torque acts on the joint alone.
  bool has_inertia = false;
};

/// A drive's torque is that of its command delay_s before, behind a first-order low-pass of lag_s.
struct DriveLateness {
  double delay_s = 0.0;
  double lag_s = 0.0;
};

/// Adds to the equation of motion:  (I + ΔI) ddq + C dq + K = tau + torque().
///
/// Some effects have a memory (lag, delay, hysteresis, a motor behind a spring). It belongs to the instant of
/// the newest sample given to reset() or advance(), and what torque() says follows from one rule:
///   torque(x) is what it is after advance(x, dt), dt the time from the memory's instant to x.time_s.
/// So it is the same just before and just after the memory moves to x; an integrator may call it at trial
/// states within its step, and gets the memory of that trial instant; at x.time_s not after the memory's
/// instant, the memory counts as it is. On the way from the memory's instant to x, the torque goes as
/// x.torque_held says and the other signals from value to value. Orders that agree with this:
///   loop and diagnosis:  reset(x0), then for every sample  advance(x, dt), torque(x);
///   simulation:          reset(x0), then for every step    torque(trials …), advance(x at its end, h).
/// Results depend on dt, 0.05 to 10 ms, only as far as the signals between samples do. Samples that are no
/// numbers leave the memory alone. No call allocates or throws.
class Effect {
 public:
  virtual ~Effect() = default;

  virtual const EffectDescriptor& descriptor() const noexcept = 0;
  /// Joint on which the effect acts, from 0.
  virtual int joint() const noexcept = 0;
  /// Values in the order of descriptor().parameters.
  virtual std::span<const double> parameters() const noexcept = 0;

  /// Generalised torque on the leg at zero acceleration, N·m, at the instant of `input`.
  virtual JointVector torque(const EffectInput& input) const noexcept = 0;
  /// ΔI(q), kg·m²; zero for most effects.
  virtual JointMatrix inertia(const JointVector& q) const noexcept {
    return JointMatrix::Zero(q.size(), q.size());
  }
  /// What the effect makes of the time from a drive's command to its torque; nothing for most effects.
  virtual DriveLateness lateness() const noexcept { return {}; }
  /// Moves the memory to the instant of `input`, dt_s > 0 after the last; stateless effects do nothing.
  virtual void advance(const EffectInput& /*input*/, double /*dt_s*/) noexcept {}
  /// Forgets the memory, as when the loop is enabled anew: `input` has lasted for ever.
  virtual void reset(const EffectInput& /*input*/) noexcept {}
};

/// Every effect the model can be given, in the order of the documentation.
std::span<const EffectDescriptor* const> effectCatalogue() noexcept;

/// Descriptor of a kind, or nullptr.
const EffectDescriptor* findEffect(std::string_view kind) noexcept;

/// Makes an effect on a joint of a mechanism, which must outlive it (DynamicsModel keeps both). Throws
/// std::invalid_argument naming the kind, the parameter, its value and its range when the kind is unknown,
/// the number of values is wrong, a value is out of range or the joint does not exist.
std::unique_ptr<Effect> makeEffect(std::string_view kind, int joint, const Mechanism& mechanism,
                                   std::span<const double> parameters);

}  // namespace patella::model
