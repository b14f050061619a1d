// The data and the script of figures that can be looked into.
#include "tools/report/interactive.hpp"

#include <cmath>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tools/report/html.hpp"

using namespace patella::report;

namespace {

Figure someFigure() {
  Figure figure;
  figure.title = "Torque </script> & more";
  figure.y_label = "N·m";
  figure.x_range = {0.0, 2.0};
  figure.zoom = true;
  figure.levels = {{.value = 4.0, .label = "limit", .vertical = false}};
  figure.shades = {{.from = 1.0, .to = 2.0, .colour = "#EEF1F4"}};
  figure.series.push_back({.label = "measured",
                           .colour = "#222222",
                           .x = {0.0, 1.0, 2.0},
                           .y = {1.23456789, std::nan(""), -3e-9},
                           .error = {}});
  return figure;
}

}  // namespace

TEST_CASE("curves are JSON that no label can end") {
  const std::string element = curveElement(someFigure());
  const std::size_t from = element.find('>') + 1;
  const std::size_t to = element.find("</script>");
  REQUIRE(to == element.rfind("</script>"));
  const auto data = nlohmann::json::parse(element.substr(from, to - from));
  CHECK(data["title"] == "Torque </script> & more");
  CHECK(data["x_range"] == nlohmann::json{0.0, 2.0});
  CHECK(data["levels"][0]["value"] == 4.0);
  CHECK(data["shades"][0]["from"] == 1.0);
  REQUIRE(data["series"].size() == 1);
  CHECK(data["series"][0]["label"] == "measured");
  CHECK(data["series"][0]["x"] == nlohmann::json{0.0, 1.0, 2.0});
  CHECK(data["series"][0]["y"][0] == 1.2346);
  CHECK(data["series"][0]["y"][1].is_null());
  CHECK(data["series"][0]["y"][2] == -3e-9);
}

TEST_CASE("a page holds the script where it has such figures, and only there") {
  const std::vector<std::string> pictures{"<svg></svg>"};
  std::vector<Figure> figures{someFigure()};
  const std::string page = pageAround("Page", figureSections(figures, pictures));
  CHECK(page.find("class Chart") != std::string::npos);
  CHECK(page.find("<svg></svg>") != std::string::npos);
  figures[0].zoom = false;
  const std::string still = pageAround("Page", figureSections(figures, pictures));
  CHECK(still.find("<script") == std::string::npos);
}
