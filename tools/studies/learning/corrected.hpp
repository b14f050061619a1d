// A network on top of an observer: what it is trained on, and what comes out at the encoder's rate.
#pragma once

#include <string>
#include <vector>

#include "tools/studies/observers/evaluation.hpp"
#include "tools/studies/observers/methods.hpp"
#include "tools/train/preparation.hpp"
#include "tools/train/trainer.hpp"

namespace patella::study {

/// An observer with its numbers.
struct Tuned {
  const Method* method = nullptr;
  std::vector<double> values;
};

/// A recording behind the loop's front end with that observer, and the truth as f_u of the loop's model.
struct ObservedRun {
  train::Observed observed;
  train::Rows truth;     ///< rad/s²
  train::Rows shank_Nm;  ///< joint torques that ShankShare explains
};

/// Inputs and targets of a learner.
struct Inputs {
  train::PreparationOptions preparation;
  bool shank_share = false;  ///< besides its features: what ShankShare explains, joint by joint
};

/// In the order of the inputs.
std::vector<std::string> namesOf(const Inputs& inputs);

ObservedRun observeRun(const Recording& recording, const Tuned& observer);

/// Sequence of a run in which every step but the first and the last second has the role.
train::Sequence sequenceOf(const ObservedRun& run, const Inputs& inputs, train::Role role,
                           const std::string& name);

/// Estimates beside truth, joint by joint, N·m, at every encoder sample after settling.
using Delivered = Trace;

/// The observer alone, held for the horizon.
Delivered deliverObserver(const ObservedRun& run, double horizon_s);
/// As the loop delivers it: a step every 1 / rate_Hz, its output held, and added to the observer's
/// newest estimate where it is a correction.
Delivered deliverNetwork(const ObservedRun& run, const Inputs& inputs,
                         const network::NetworkWeights& weights);

/// Appends an estimate, and the truth at that sample of the run, as joint torque.
void append(Delivered& trace, const JointVector& estimate_Nm, const ObservedRun& run, Eigen::Index sample);
/// Appends one trace to another.
void append(Delivered& all, const Delivered& more);

}  // namespace patella::study
