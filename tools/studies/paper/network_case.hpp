// One training of the paper's network, and what it is worth on what it has not seen.
#pragma once

#include <functional>
#include <string>

#include "tools/studies/paper/kept_results.hpp"
#include "tools/studies/paper/material.hpp"
#include "tools/studies/paper/paper_study.hpp"

namespace patella::study {

/// As a file is called: "as_printed_1_random_seed3".
std::string fileName(const Condition& condition, train::SplitKind split, std::uint64_t seed);

/// Material of a seed with the roles of a split.
Material materialOfCase(const PaperOptions& options, const Condition& condition, train::SplitKind split,
                        std::uint64_t seed, std::span<const double> target_values);
/// Material of a motion of which all but the ends is tested on.
Material materialOfUnseen(const PaperOptions& options, const Condition& condition, Unseen unseen,
                          std::uint64_t seed, std::span<const double> target_values);

/// Empty where the training has not been done yet. Throws app::FileError.
std::optional<NetworkCase> findCase(const KeptResults& kept, const PaperOptions& options,
                                    const Condition& condition, train::SplitKind split, std::uint64_t seed);

/// Trains, or goes on with a training that was interrupted, and keeps the result.
NetworkCase trainCase(const KeptResults& kept, const PaperOptions& options, const Condition& condition,
                      train::SplitKind split, std::uint64_t seed, std::span<const double> target_values,
                      const std::function<void(const train::Progress&)>& progress);

}  // namespace patella::study
