// Drives that are known to be late: what to ask of them now for the torque the leg needs when it arrives.
//
//   A lag of time constant T is inverted as far as kQuickening allows: y arrives, w is wanted, u is asked
//   for,
//
//     u = y + (T / R)(w − y)      so that  R dy/dt = w − y,  R = T / kQuickening
//
//   What is left of it, and a delay, make up the lateness h. Torque that arrives until t + h is known at t,
//   and so is the motion until then. A joint's torque is the one for the state and reference of all joints
//   when it arrives:
//
//     dq(t + h) = dq + ∫₀ʰ ddq ds          ddq = M⁻¹ (w(t + s − h) − bias) + f̂_u
//     q(t + h)  = q + h dq + ∫₀ʰ (h − s) ddq ds
//
//   Source: Smith, A controller to overcome dead time, ISA Journal 6(2), 1959; for a plant that integrates,
//   Manitius and Olbrot, IEEE Trans. Automatic Control 24(4), 1979, 541–553.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "core/model/dynamics_model.hpp"
#include "core/types.hpp"

namespace patella::control {

class DriveAnticipation {
 public:
  /// Lateness of each joint's drive, as the model has it; `period_s` from one command to the next. Throws
  /// std::invalid_argument naming the value where one is negative or longer than kLongest_s.
  DriveAnticipation(int joints, const std::array<model::DriveLateness, kMaxJoints>& lateness,
                    double period_s);

  static constexpr double kLongest_s = 0.3;
  /// A lag becomes so much shorter; the noise of the demand grows as much.
  static constexpr double kQuickening = 4.0;

  /// Time from a demand to its torque, s, once a lag has been quickened.
  static double lateness_s(const model::DriveLateness& lateness, double period_s) noexcept;

  /// False where no drive is late: there is nothing to look ahead to.
  bool needed() const noexcept { return needed_; }
  double lateness_s(Eigen::Index joint) const noexcept {
    return drives_[static_cast<std::size_t>(joint)].late_s;
  }
  /// The different ones among the joints' lateness, ascending.
  std::span<const double> horizons_s() const noexcept { return horizons_s_; }

  /// Moves all joints' positions, rad, and velocities, rad/s, on by `horizon_s`. `terms` are those of the
  /// present state; `f_hat`, rad/s², is what else is thought to act.
  void lookAhead(const model::ModelTerms& terms, const JointVector& f_hat, double horizon_s, JointVector& q,
                 JointVector& dq) const noexcept PATELLA_NONBLOCKING;
  /// What to ask of the drives beyond `demand_Nm` for it to arrive sooner, N·m.
  JointVector quickening(const JointVector& demand_Nm) const noexcept PATELLA_NONBLOCKING;
  /// What they were asked for in the end; every tick.
  void commanded(const JointVector& torque_Nm) noexcept PATELLA_NONBLOCKING;

 private:
  struct Drive {
    double late_s = 0.0;
    double quickening = 1.0;         ///< T / R
    double approach = 1.0;           ///< share of the way to the command that a lag goes in a period
    double arriving_Nm = 0.0;        ///< y, but for the delay
    std::vector<double> demands_Nm;  ///< w, newest first from newest_ on, around the end
  };
  /// ∫₀ʰ w ds and ∫₀ʰ (h − s) w ds of what one joint's drive gives from now on.
  struct Moments {
    double first = 0.0;   ///< N·m·s
    double second = 0.0;  ///< N·m·s²
  };
  Moments moments(const Drive& drive, double horizon_s) const noexcept;

  std::vector<Drive> drives_;
  std::vector<double> horizons_s_;
  double period_s_;
  bool needed_ = false;
  std::size_t newest_ = 0;
};

}  // namespace patella::control
