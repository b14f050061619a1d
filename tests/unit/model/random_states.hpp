// States at which identities of the equations of motion are checked.
#pragma once

#include <random>
#include <vector>

#include "core/types.hpp"

namespace patella::test {

struct State {
  JointVector q;
  JointVector dq;
  JointVector ddq;
};

/// The same sequence on every call.
inline std::vector<State> randomStates(int joints, int count = 50) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-3.0, 3.0);
  std::uniform_real_distribution<double> rate(-8.0, 8.0);
  std::uniform_real_distribution<double> acceleration(-60.0, 60.0);
  std::vector<State> states;
  for (int n = 0; n < count; ++n) {
    State state{JointVector(joints), JointVector(joints), JointVector(joints)};
    for (int i = 0; i < joints; ++i) {
      state.q[i] = angle(random);
      state.dq[i] = rate(random);
      state.ddq[i] = acceleration(random);
    }
    states.push_back(state);
  }
  return states;
}

}  // namespace patella::test
