// What the summary of a run says beside its ticks.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace patella::report {

/// First value of this name in a nested summary; null where there is none.
const nlohmann::json* findKey(const nlohmann::json& node, const std::string& key);

/// Quantiles of durations as the loop printed them at the end of the run, where its summary has them under
/// `key`; else of `values`.
std::string quantilesText(std::span<const double> values, const nlohmann::json& summary, const char* key);

/// What to say where the run counted another number of ticks than the table has; empty where all are there. A
/// file that was cut off between two lines looks whole by itself.
std::string missingTicks(std::size_t ticks, const nlohmann::json& summary);

}  // namespace patella::report
