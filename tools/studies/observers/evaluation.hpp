// Runs a method over a recording, and finds the numbers that suit it.
#pragma once

#include <span>
#include <vector>

#include "tools/studies/observers/condition.hpp"
#include "tools/studies/observers/methods.hpp"

namespace patella::study {

/// Left out at the beginning, s; as much is left out at the end, where a smoother sees no future.
inline constexpr double kSettling_s = 1.0;

/// Estimates beside the truth, joint by joint, after settling; rad/s², or N·m where the encoder is alone.
struct Trace {
  std::array<std::vector<double>, 2> estimate;
  std::array<std::vector<double>, 2> truth;
};

/// An estimate is held against the truth of the sample at which it is given, its delay included; that of a
/// delayed method against the sample that it is of.
Trace follow(const Method& method, std::span<const double> values, const Recording& recording);

/// Mean |estimate − truth|; infinite when an estimate is no number.
std::array<double, 2> meanError(const Trace& trace);

/// By which the estimates come after the truth, s: where their cross-correlation is largest.
std::array<double, 2> delay_s(const Trace& trace);

/// The rule by which every method is tuned in every condition: a number is multiplied or divided by a factor
/// for as long as the mean error, summed over joints and recordings, falls. It is done with both joints'
/// values of a number together, then with each alone, then with all numbers of a joint together (the valleys
/// of observers with two gains lie askew), for the factors 4, 2 and √2 in turn. Numbers begin where methods()
/// says and stay within 1/1000 to 1000 times their start.
std::vector<double> tune(const Method& method, std::span<const Recording> recordings);

}  // namespace patella::study
