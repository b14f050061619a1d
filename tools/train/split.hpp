// Which steps are trained on, which choose among networks, and which tell how good the chosen one is.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "tools/train/sequence.hpp"

namespace patella::train {

enum class SplitKind : std::uint8_t {
  kRandom,         ///< each step by lot, as the paper: neighbours of every tested step are trained on
  kBlocked,        ///< stretches of block_s by lot
  kChronological,  ///< the end of each recording
  kRecording,      ///< whole recordings by lot
};

/// As written on the command line: random, blocked, chronological, recording.
const std::vector<std::string>& splitNames();

struct SplitOptions {
  SplitKind kind = SplitKind::kBlocked;
  double validation_share = 0.15;
  double test_share = 0.15;
  double block_s = 5.0;
  /// Left out where roles meet, and at the ends of a recording, where observers settle; not by kRandom.
  double gap_s = 0.0;
  double settling_s = 1.0;
  std::uint64_t seed = 1;
};

/// Gives every step of every sequence its role. Sequences of one recording share theirs where whole
/// recordings are dealt out. Throws std::invalid_argument where a share that is asked for would be empty.
void assignRoles(std::span<Sequence> sequences, const SplitOptions& options);

/// Whole recordings to one role, but for the settling at both ends.
void assignRole(Sequence& sequence, Role role, double settling_s);

std::size_t countOf(std::span<const Sequence> sequences, Role role);

}  // namespace patella::train
