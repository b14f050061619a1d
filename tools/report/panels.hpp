// The panels that an engineer looks at after a run, from the columns that the run recorded.
#pragma once

#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "firmware_app/files/csv_table.hpp"
#include "tools/report/figure.hpp"

namespace patella::report {

/// Figures in the order of the page. A figure whose columns are absent or hold no numbers is left out.
/// Torque limits are taken from `torque_limit_Nm` (a number, or one for each joint) anywhere in the summary.
std::vector<Figure> makePanels(const app::CsvTable& ticks, const nlohmann::json& summary);

}  // namespace patella::report
