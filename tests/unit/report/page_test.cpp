// A whole report, drawn by gnuplot.
#include <algorithm>
#include <cstdlib>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/count_of.hpp"
#include "tests/support/recording_text.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/report/gnuplot.hpp"
#include "tools/report/html.hpp"
#include "tools/report/panels.hpp"

using namespace patella;
using namespace patella::report;
using patella::test::countOf;

namespace {

std::vector<Figure> someFigures() {
  return makePanels(
      app::CsvTable::parse("t_s,q1_rad,state,wakeup_us\n0,1,1,5\n1,2,2,6\n2,3,2,9\n", "ticks.csv"),
      nlohmann::json::object());
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

TEST_CASE("the page explains the shades that its figures have, and no others") {
  const auto pageOf = [](const char* rows) {
    const auto figures =
        makePanels(app::CsvTable::parse("t_s,q1_rad,limits,faults\n" + std::string(rows), "ticks.csv"),
                   nlohmann::json());
    const std::vector<std::string> pictures(figures.size());
    return reportPage("Run 7", figures, pictures, nlohmann::json::object());
  };
  const auto holds = [](const std::string& page, const char* words) {
    return page.find(words) != std::string::npos;
  };
  const std::string sound = pageOf("0,1,0,0\n1,2,0,0\n");
  CHECK_FALSE(holds(sound, "torque held back"));
  CHECK_FALSE(holds(sound, ">fault<"));
  const std::string limited = pageOf("0,1,0,0\n1,2,4,0\n2,2,0,0\n");
  CHECK(holds(limited, "torque held back by a limit"));
  CHECK_FALSE(holds(limited, ">fault<"));
  CHECK(holds(pageOf("0,1,0,0\n1,2,0,1\n2,2,0,1\n"), ">fault<"));
}

TEST_CASE("dots, error bars, ranked bars with marks and words, logarithmic axes") {
  Figure scatter;
  scatter.title = "Scatter";
  scatter.log_x = true;
  scatter.log_y = true;
  scatter.series.push_back({.label = "dots",
                            .colour = "#0072B2",
                            .x = {1, 2, 30},
                            .y = {0.5, 3, 40},
                            .points = true,
                            .error = {}});
  scatter.series.push_back(
      {.label = "mean", .colour = "#D55E00", .x = {1, 20}, .y = {1, 20}, .error = {0.5, 3}});
  Figure ranking;
  ranking.title = "Ranking";
  ranking.rows = {"first of them", "second"};
  ranking.x_range = {0.0, 10.0};
  ranking.x_ticks = {0.0, 5.0};
  ranking.bars = {{.row = 0, .from = 0.0, .to = 6.0, .colour = "#009E73"}};
  ranking.row_marks = {{.row = 0, .at = 2.0, .colour = "#123456"}};
  ranking.row_notes = {{.row = 1, .at = 1.0, .text = "words here"}};
  ranking.levels = {{.value = 4.0, .label = "upright", .vertical = true}};
  const std::vector<Figure> figures{scatter, ranking};
  const std::vector<std::string> pictures = drawSvg(figures);
  REQUIRE(pictures.size() == 2);
  for (const char* text : {"dots", "mean", "Scatter"}) {
    CAPTURE(text);
    CHECK(pictures[0].find(text) != std::string::npos);
  }
  for (const char* text :
       {"first of them", "second", "words here", "upright", "rgb( 18,  52,  86)", "> 5<"}) {
    CAPTURE(text);
    CHECK(pictures[1].find(text) != std::string::npos);
  }
  CHECK(pictures[1].find("> 10<") == std::string::npos);
}

TEST_CASE("a table escapes what is in it") {
  const std::string table = tableText({.title = "<T>", .header = {"", "x & y"}, .rows = {{"a", "<1>"}}});
  CHECK(table.find("&lt;T&gt;") != std::string::npos);
  CHECK(table.find("<th>x &amp; y</th>") != std::string::npos);
  CHECK(table.find("<td>&lt;1&gt;</td>") != std::string::npos);
}

TEST_CASE("a picture is a PNG, and appears whole or not at all") {
  const test::ScratchFolder folder;
  drawPng(someFigures(), "Run 7", folder / "run.png");
  CHECK(app::readFile(folder / "run.png", test::kRecordingText).starts_with("\x89PNG"));
  CHECK_THROWS_AS(drawPng(someFigures(), "Run 7", folder / "absent/run.png"), app::FileError);
  CHECK(folder.entries() == 1);
}
