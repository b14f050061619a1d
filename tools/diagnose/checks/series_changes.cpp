#include "tools/diagnose/checks/series_changes.hpp"

#include <vector>

#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

// One joint's signal as samples, to be differentiated.
std::vector<double> torqueOf(const Series& series, Eigen::Index joint) {
  std::vector<double> torque;
  torque.reserve(series.measured_torque_Nm.size());
  for (const JointVector& all : series.measured_torque_Nm) {
    torque.push_back(all[joint]);
  }
  return torque;
}

}  // namespace

void turnPositions(Series& series, const JointMatrix& matrix, const JointVector& zero) {
  for (std::size_t i = 0; i < series.states.size(); ++i) {
    model::EffectInput& state = series.states[i];
    state.q = (matrix * (state.q - zero) + zero).eval();
    state.dq = (matrix * state.dq).eval();
    series.acceleration[i] = (matrix * series.acceleration[i]).eval();
  }
}

void turnTorques(Series& series, const JointMatrix& matrix) {
  for (JointVector& torque_Nm : series.measured_torque_Nm) {
    torque_Nm = (matrix * torque_Nm).eval();
  }
}

void exchangeColumns(Series& series, Eigen::Index joint) {
  const std::vector<double> position = torqueOf(series, joint);
  const std::vector<double> velocity = offline::derivative(position, series.rate_Hz);
  const std::vector<double> acceleration = offline::derivative(velocity, series.rate_Hz);
  for (std::size_t i = 0; i < position.size(); ++i) {
    series.measured_torque_Nm[i][joint] = series.states[i].q[joint];
    series.states[i].q[joint] = position[i];
    series.states[i].dq[joint] = velocity[i];
    series.acceleration[i][joint] = acceleration[i];
  }
}

void advanceTorque(Series& series, Eigen::Index joint, double late_s) {
  const std::vector<double> advanced = offline::advanced(torqueOf(series, joint), late_s, series.rate_Hz);
  for (std::size_t i = 0; i < advanced.size(); ++i) {
    series.measured_torque_Nm[i][joint] = advanced[i];
  }
}

}  // namespace patella::diagnose
