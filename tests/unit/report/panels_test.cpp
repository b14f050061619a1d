#include "tools/report/panels.hpp"

#include <algorithm>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "tools/report/gnuplot.hpp"
#include "tools/report/summary_values.hpp"

using namespace patella;
using namespace patella::report;

namespace {

std::vector<Figure> panelsOf(const std::string& csv,
                             const nlohmann::json& summary = nlohmann::json::object()) {
  return makePanels(app::CsvTable::parse(csv, "ticks.csv", {.allow_missing = true}), summary);
}

const Figure* find(const std::vector<Figure>& figures, const std::string& title) {
  const auto found = std::find_if(figures.begin(), figures.end(),
                                  [&](const Figure& figure) { return figure.title.starts_with(title); });
  return found == figures.end() ? nullptr : &*found;
}

}  // namespace

TEST_CASE("where the truth is known the network's error stands beside the sampler's, with its mean") {
  const std::string csv =
      "t_s,f_true1_rad_s2,f_s1_rad_s2,f_s_filtered1_rad_s2,f_network1_rad_s2\n0,1,3,0,\n1,1,-1,0,1.5\n2,1,3,"
      "0,0.5\n";
  const auto figures = panelsOf(csv);
  const Figure* errors = find(figures, "Error of f_u, joint 1");
  REQUIRE(errors != nullptr);
  REQUIRE(errors->series.size() == 3);
  CHECK(errors->series[0].label == "sampler 2");
  CHECK(errors->series[1].label == "filtered 1");
  CHECK(errors->series[2].label == "network 0.5");
  CHECK(find(panelsOf("t_s,f_true1_rad_s2,f_s1_rad_s2\n0,1,3\n1,1,2\n"), "Error of f_u") == nullptr);
}

TEST_CASE("only what was recorded is drawn") {
  const std::vector<Figure> figures = panelsOf("t_s,q1_rad,ref1_rad,emg1_mV\n0,1,,0\n0.5,2,1,0\n1,3,1,0\n");
  REQUIRE(figures.size() == 1);
  CHECK(figures[0].title == "Angle, joint 1");
  REQUIRE(figures[0].series.size() == 2);
  CHECK(figures[0].series[0].label == "reference");
  CHECK(figures[0].series[1].y == std::vector<double>{1, 2, 3});
  CHECK(figures[0].zoom);
  CHECK(panelsOf("t_s\n0\n1\n").empty());
}

TEST_CASE("torque is drawn with the limits of the summary, wherever they stand in it") {
  const std::string csv = "t_s,tau_cmd1_Nm,tau_cmd2_Nm\n0,1,1\n1,2,2\n";
  const auto figures = panelsOf(csv, {{"safety", {{"torque_limit_Nm", {30.0, 20.0}}}}});
  REQUIRE(find(figures, "Torque, joint 2") != nullptr);
  REQUIRE(find(figures, "Torque, joint 2")->levels.size() == 2);
  CHECK(find(figures, "Torque, joint 2")->levels[0].value == 20.0);
  CHECK(find(figures, "Torque, joint 2")->levels[1].value == -20.0);
  CHECK(find(panelsOf(csv), "Torque, joint 2")->levels.empty());
}

TEST_CASE("the timeline has a row for every state and for each fault that occurred") {
  const auto figures = panelsOf("t_s,state,faults\n0,1,0\n1,2,0\n2,4,9\n3,4,9\n4,1,0\n");
  const Figure* timeline = find(figures, "State");
  REQUIRE(timeline != nullptr);
  CHECK(timeline->rows == std::vector<std::string>{"init", "ready", "active", "limited", "fault",
                                                   "emergency_stop", "drive_stale"});
  const auto stop =
      std::find_if(timeline->bars.begin(), timeline->bars.end(), [](const Bar& bar) { return bar.row == 5; });
  REQUIRE(stop != timeline->bars.end());
  CHECK(stop->from == 2.0);
  CHECK(stop->to == 4.0);
}

TEST_CASE("the zoom shows the second in which the unknown dynamics are largest while torque flows") {
  std::string csv = "t_s,state,f_s1_rad_s2\n";
  for (int i = 0; i <= 1000; ++i) {
    const double t = 0.01 * i;
    const bool active = t < 8.0;
    const double f = t >= 5.0 && t < 6.0 ? 3.0 : t >= 8.0 || t < 0.5 ? 100.0 : 1.0;
    csv += std::to_string(t) + (active ? ",2," : ",4,") + std::to_string(f) + "\n";
  }
  const auto figures = panelsOf(csv);
  const Figure* zoom = find(figures, "f_u, joint 1, 1 s");
  REQUIRE(zoom != nullptr);
  REQUIRE(zoom->x_range.has_value());
  CHECK(zoom->x_range->first == doctest::Approx(5.0));
  CHECK(zoom->x_range->second == doctest::Approx(5.99));
}

TEST_CASE("a limit far from the curve is not drawn, one near it is") {
  const std::string csv = "t_s,tau_cmd1_Nm\n0,1\n1,2\n";
  const auto drawn = [&](double limit_Nm) {
    const auto figures = panelsOf(csv, {{"torque_limit_Nm", limit_Nm}});
    return drawSvg(figures)[0].find("rgb(176,   0,  32)") != std::string::npos;
  };
  CHECK(drawn(2.5));
  CHECK_FALSE(drawn(500.0));
}

TEST_CASE("a histogram's title says what the summary says in plain numbers, its axis where the bars end") {
  std::string csv = "t_s,wakeup_us\n";
  for (int i = 0; i < 20'000; ++i) {
    csv += std::to_string(i) + "," + std::to_string(i % 50) + "\n";
  }
  const auto figures = panelsOf(csv + "20000,12700\n");
  const Figure* timing = find(figures, "Wake-up latency");
  REQUIRE(timing != nullptr);
  CHECK(timing->title == "Wake-up latency (p50 25.0, p99.9 49.0, max 12700.0 µs)");
  CHECK(timing->x_label == "µs (the last bar holds all above)");
  const auto said = panelsOf(
      csv, {{"timing", {{"wakeup_latency", {{"p50_us", 24.5}, {"p99_9_us", 49.7}, {"max_us", 1270.04}}}}}});
  CHECK(find(said, "Wake-up latency")->title == "Wake-up latency (p50 24.5, p99.9 49.7, max 1270.0 µs)");
  CHECK(find(said, "Wake-up latency")->x_label == "µs");
}

TEST_CASE("a table with other ticks than the run counted is told of") {
  CHECK(missingTicks(1000, {{"ticks", 1000}}).empty());
  CHECK(missingTicks(1000, nlohmann::json::object()).empty());
  CHECK(missingTicks(800, {{"ticks", 1000}}).starts_with("800 ticks, expected the 1000 that summary.json"));
}

TEST_CASE("times that are all zero, as in virtual time, make no histogram") {
  CHECK(find(panelsOf("t_s,wakeup_us\n0,0\n1,0\n"), "Wake-up latency") == nullptr);
  const auto figures = panelsOf("t_s,wakeup_us\n0,3\n1,4\n");
  CHECK(std::any_of(figures.begin(), figures.end(), [](const Figure& f) { return f.histogram.has_value(); }));
}
