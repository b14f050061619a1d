// The report as one file that needs nothing beside it.
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "tools/report/figure.hpp"

namespace patella::report {

/// `pictures` are SVG documents, one for each figure. Figures of one section stand together; the summary
/// follows as tables, one for each of its objects.
std::string reportPage(const std::string& title, std::span<const Figure> figures,
                       std::span<const std::string> pictures, const nlohmann::json& summary);

}  // namespace patella::report
