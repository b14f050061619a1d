#include "core/estimation/terminal_sliding_observer.hpp"

#include <cmath>

#include "core/bounds/bounds.hpp"
#include "core/estimation/fractional_root.hpp"
#include "core/estimation/sampler_parameters.hpp"

namespace patella::estimation {
namespace {

TerminalSlidingParameters checked(const TerminalSlidingParameters& p) {
  requireBound(boundOf("estimation.terminal_linear_1_s"), p.terminal_linear);
  requireBound(boundOf("estimation.terminal_fractional"), p.terminal_fractional);
  requireOddExponent(p.p0, p.q0);
  requireBound(boundOf("estimation.reaching_1_s"), p.reaching);
  requireBound(boundOf("estimation.switching_rad_s2"), p.switching);
  requireBound(boundOf("estimation.boundary_rad_s"), p.boundary);
  return p;
}

}  // namespace

TerminalSlidingObserver::TerminalSlidingObserver(const TerminalSlidingParameters& parameters)
    : parameters_(checked(parameters)) {}

void TerminalSlidingObserver::reset(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  known_.reset(input);
  previous_dq_ = input.dq;
  e_ = JointVector::Zero(input.dq.size());
  s_ = e_;
}

JointVector TerminalSlidingObserver::update(const ObserverInput& input) noexcept PATELLA_NONBLOCKING {
  const double dt = input.dt_s;
  const JointVector unknown = input.dq - previous_dq_ - dt * known_.advance(input);
  previous_dq_ = input.dq;
  JointVector injection(unknown.size());
  for (Eigen::Index joint = 0; joint < unknown.size(); ++joint) {
    // The terms of the surface cancel in s, which is therefore found first.
    const double reaching = reachingTerm(s_[joint] + unknown[joint], dt, s_[joint]);
    injection[joint] = reaching + terminalTerm(e_[joint] + unknown[joint] - dt * reaching, dt, e_[joint]);
  }
  return injection;
}

double TerminalSlidingObserver::reachingTerm(double start, double dt_s, double& s) const noexcept {
  const auto& p = parameters_;
  s = start / (1.0 + dt_s * (p.reaching + p.switching / p.boundary));
  if (std::abs(s) > p.boundary) {
    s = (start - std::copysign(dt_s * p.switching, start)) / (1.0 + dt_s * p.reaching);
  }
  return (start - s) / dt_s;
}

double TerminalSlidingObserver::terminalTerm(double start, double dt_s, double& e) const noexcept {
  const auto& p = parameters_;
  e = std::copysign(fractionalRoot(1.0 + dt_s * p.terminal_linear, dt_s * p.terminal_fractional, p.p0, p.q0,
                                   std::abs(start)),
                    start);
  return (start - e) / dt_s;
}

}  // namespace patella::estimation
