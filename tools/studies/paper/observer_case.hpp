// One observer in one condition, tuned and measured, or as kept.
#pragma once

#include <optional>
#include <string>

#include "tools/studies/paper/kept_results.hpp"
#include "tools/studies/paper/paper_study.hpp"

namespace patella::study {

/// Recordings are long and are made when the first method needs them.
struct ObserverMaterial {
  std::vector<Recording> tuning;
  std::vector<Recording> measured;
};
ObserverMaterial observerMaterial(const PaperOptions& options, const Condition& condition);

/// Empty where it has not been measured yet. Throws app::FileError.
std::optional<Result> findObserver(const KeptResults& kept, const PaperOptions& options,
                                   const Condition& condition, const Method& method);
Result measureObserver(const KeptResults& kept, const PaperOptions& options, const ObserverMaterial& material,
                       const Method& method);

}  // namespace patella::study
