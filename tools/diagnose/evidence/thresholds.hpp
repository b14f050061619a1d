// Every number that decides something in the inference by evidence, and why it stands there.
#pragma once

namespace patella::diagnose::evidence::threshold {

/// Nats by which an effect must make a recording likelier, its prior and the choice among its forms paid for.
/// The largest score of some hundred forms in a recording that lacks nothing stays below 5 in 99 of 100.
inline constexpr double kLeastGain = 5.0;
/// Models within so many nats of the best cannot be told from it: 1 to 20 against them.
inline constexpr double kSameEvidence = 3.0;
/// Nats that functions of motion and time must bring together to count as structure. Their scales, some
/// thirty, are free and cost nothing, so that they bring up to 10 where there is none.
inline constexpr double kLeastStructure = 10.0;
/// Independent looks at a joint's structure that no recording exceeds: what is left by a model that is wrong
/// is a function of the motion, which says the same again and again however long it is watched.
inline constexpr double kLooks = 12.0;
/// Share (rms) of what was missing from which structure without a name is something else that is missing;
/// what is less is the difference between the form of a named effect and the machine's.
inline constexpr double kMaterialShare = 0.35;
/// Share of a joint's torque (rms) that a model of which nothing is said to be missing may leave beyond
/// noise.
inline constexpr double kNegligibleRest = 0.05;
/// Error of the best rigid-body model as a share of its torque: no model is better, whatever sensors resolve.
inline constexpr double kRigidDiscrepancy = 0.01;

}  // namespace patella::diagnose::evidence::threshold
