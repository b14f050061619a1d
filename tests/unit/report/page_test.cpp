// A whole report, drawn by gnuplot.
#include <algorithm>
#include <cstdlib>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/unit/files/scratch_folder.hpp"
#include "tools/report/gnuplot.hpp"
#include "tools/report/html.hpp"
#include "tools/report/panels.hpp"

using namespace patella;
using namespace patella::report;

namespace {

std::vector<Figure> someFigures() {
  return makePanels(
      app::CsvTable::parse("t_s,q1_rad,state,wakeup_us\n0,1,1,5\n1,2,2,6\n2,3,2,9\n", "ticks.csv"),
      nlohmann::json::object());
}

std::size_t countOf(const std::string& text, const std::string& part) {
  std::size_t count = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++count;
  }
  return count;
}

}  // namespace

TEST_CASE("a page holds every figure and every number of the summary, and nothing from elsewhere") {
  const std::vector<Figure> figures = someFigures();
  REQUIRE(figures.size() == 3);
  const std::vector<std::string> pictures = drawSvg(figures);
  const nlohmann::json summary = {{"ticks", 30000},
                                  {"name", "<leg & \"knee\">"},
                                  {"timing", {{"wakeup", {{"p99_us", 17.25}}}}},
                                  {"faults", {{{"cause", "bus_off"}}}},
                                  {"limits_Nm", {30.0, 20.0}}};
  const std::string page = reportPage("Run 7", figures, pictures, summary);
  CHECK(countOf(page, "<svg") == 3);
  CHECK(countOf(page, "</svg>") == 3);
  for (const char* text :
       {"Angle, joint 1", "Wake-up latency", "active", "Run 7", "30000", "30, 20", "17.25", "timing › wakeup",
        "faults › 1", "bus_off", "&lt;leg &amp; &quot;knee&quot;&gt;"}) {
    CAPTURE(text);
    CHECK(page.find(text) != std::string::npos);
  }
  CHECK(page.find("src=") == std::string::npos);
  CHECK(page.find("<leg") == std::string::npos);
}

TEST_CASE("a picture is a PNG, and appears whole or not at all") {
  const test::ScratchFolder folder;
  drawPng(someFigures(), "Run 7", folder / "run.png");
  CHECK(app::readFile(folder / "run.png").starts_with("\x89PNG"));
  CHECK_THROWS_AS(drawPng(someFigures(), "Run 7", folder / "absent/run.png"), app::FileError);
  CHECK(folder.entries() == 1);
}
