// Sequences cut into the pieces through which errors are propagated back.
#pragma once

#include <span>
#include <vector>

#include "sim/random.hpp"
#include "tools/train/sequence.hpp"

namespace patella::train {

struct Window {
  std::size_t sequence = 0;
  Eigen::Index begin = 0;    ///< first step
  Eigen::Index count = 0;    ///< steps, at most those asked for
  Eigen::Index burn_in = 0;  ///< first of them, which are not learned from
};

/// Pieces of `length` steps, of which the first `burn_in` are also the end of the piece before, in an order
/// drawn by lot; where they begin is drawn, too. A piece at the beginning of a sequence needs no burn-in, as
/// the loop begins there without a past. Pieces in which nothing is trained on are left out.
std::vector<Window> drawWindows(std::span<const Sequence> sequences, Eigen::Index length,
                                Eigen::Index burn_in, sim::Random& random);

}  // namespace patella::train
