#include "core/model/chain/probe_states.hpp"

#include <numbers>
#include <random>

namespace patella::model::chain {
namespace {

constexpr int kStates = 60;
constexpr double kFastest = 3.0;
constexpr double kSteepest = 10.0;

/// The library's distributions differ from one implementation to another, its generators do not.
double between(std::mt19937_64& random, double limit) {
  return limit * (2.0 * static_cast<double>(random() >> 11U) * 0x1p-53 - 1.0);
}

}  // namespace

std::vector<ProbeState> probeStates(int joints) {
  std::mt19937_64 random(1);
  std::vector<ProbeState> states;
  for (int n = 0; n < kStates; ++n) {
    ProbeState state{JointVector(joints), JointVector(joints), JointVector(joints)};
    for (int joint = 0; joint < joints; ++joint) {
      state.q[joint] = between(random, std::numbers::pi);
      state.dq[joint] = between(random, kFastest);
      state.ddq[joint] = between(random, kSteepest);
    }
    states.push_back(std::move(state));
  }
  return states;
}

}  // namespace patella::model::chain
