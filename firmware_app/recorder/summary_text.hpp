// A run's summary as a page of text.
#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace patella::app {

/// `summary`: as summarise() makes it.
std::string summaryText(const nlohmann::ordered_json& summary);

}  // namespace patella::app
