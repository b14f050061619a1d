// The report as one file that needs nothing beside it.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "tools/report/figure.hpp"

namespace patella::report {

/// `pictures` are SVG documents, one for each figure. Figures of one section stand together; the summary
/// follows as tables, one for each of its objects.
std::string reportPage(const std::string& title, std::span<const Figure> figures,
                       std::span<const std::string> pictures, const nlohmann::json& summary);

/// The parts of such a page, for others to arrange.
std::string escaped(std::string_view text);
std::string figureSections(std::span<const Figure> figures, std::span<const std::string> pictures);

struct Table {
  std::string title;
  std::vector<std::string> header;  ///< as many cells as the rows
  std::vector<std::vector<std::string>> rows;
  bool words = false;  ///< columns hold words rather than numbers, which are aligned at the right
  std::vector<std::string> marks{};  ///< HTML behind the first cell of each row; empty: none
};
std::string tableText(const Table& table);
/// A whole page around `body`, which is HTML, with the script of the figures that can be looked into.
std::string pageAround(const std::string& title, const std::string& body);

}  // namespace patella::report
