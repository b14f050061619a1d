// One cause behind what the model lacks on all joints, which no effect of the library has.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "core/model/model_description.hpp"
#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/result/diagnosis.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Effects of single joints imitate it. Whether it is there is told by a diagnosis that has it taken out.
struct SharedCause {
  std::string words;                            ///< a sentence for people
  std::optional<Eigen::Vector3d> gravity_m_s2;  ///< of every chain, where the base stands at another angle
  double torque_late_s = 0.0;  ///< by which all torque columns come late, as through a filter
  /// Late by less than a sample may be the reader's, who takes a row's torque for held or not: it is taken
  /// out with a warning.
  bool may_be_reading = false;
  std::vector<double> torque_Nm;  ///< rms of what it explains on each joint

  bool isOfBase() const noexcept { return gravity_m_s2.has_value(); }

  /// What it is taken out of.
  model::ModelDescription takenOutOf(model::ModelDescription model) const;
  std::vector<Recording> takenOutOf(std::span<const Recording> recordings) const;
};

/// A base of chains that stands at another angle to gravity, or torque columns that all come late by the same
/// time. Beside all that the fits estimate, it explains shared::kSuspected of what `found` leaves on all
/// joints beyond noise, or, where several effects were found, unknown::kGoesWith of what `nominal` leaves.
/// Nothing of a single joint, or of postures at rest. `least_late_s`: leastLateness_s().
std::optional<SharedCause> suspectedCause(const Dataset& data, double least_late_s,
                                          const model::ModelDescription& given, const ModelFit& nominal,
                                          const ModelFit& found, const Diagnosis& diagnosis);

/// Squares of what a diagnosis leaves on each joint, counted in its torque.
double leftBy(const Diagnosis& diagnosis);

/// Whether a diagnosis with the cause taken out leaves much less than that of the recordings as they are, or
/// as little with fewer effects.
bool bearsOut(const Diagnosis& taken_out, const Diagnosis& as_given);

/// The answer of a diagnosis that bears the last of the causes out: what the library lacks is named, and what
/// there is beside it. `before`: with that cause in the recordings.
Diagnosis withCauses(std::span<const SharedCause> causes, Diagnosis taken_out, const Diagnosis& before);

}  // namespace patella::diagnose
