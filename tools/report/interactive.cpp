#include "tools/report/interactive.hpp"

#include <array>
#include <cmath>
#include <cstdio>
#include <span>

#include <nlohmann/json.hpp>

#include "tools/report/interactive_script.hpp"

namespace patella::report {
namespace {

using nlohmann::json;

constexpr const char* kCurves = "<script type=\"application/json\" class=\"curves\">";
/// As many as a screen can show of a long recording.
constexpr int kDigitsX = 7;
constexpr int kDigitsY = 5;

/// Values that are no numbers become null.
std::string numbers(std::span<const double> values, int digits) {
  std::string text = "[";
  for (const double value : values) {
    std::array<char, 32> number{};
    std::snprintf(number.data(), number.size(), "%.*g", digits, value);
    text += text.size() > 1 ? "," : "";
    text += std::isfinite(value) ? number.data() : "null";
  }
  return text + "]";
}

std::string seriesText(const Series& series) {
  std::string text = json{
      {"label", series.label},
      {"colour", series.colour},
      {"width", series.width},
      {"dashed",
       series.dashed}}.dump();
  text.pop_back();
  return text + ",\"x\":" + numbers(series.x, kDigitsX) + ",\"y\":" + numbers(series.y, kDigitsY) + "}";
}

/// An element of JSON ends at the first "</", wherever it stands.
std::string harmless(const std::string& text) {
  std::string result;
  for (const char c : text) {
    result += c == '<' ? "\\u003c" : std::string(1, c);
  }
  return result;
}

}  // namespace

std::string curveElement(const Figure& figure) {
  json frame = {{"title", figure.title},   {"x_label", figure.x_label}, {"y_label", figure.y_label},
                {"log_x", figure.log_x},   {"log_y", figure.log_y},     {"levels", json::array()},
                {"shades", json::array()}, {"x_range", json()}};
  if (figure.x_range) {
    frame["x_range"] = *figure.x_range;
  }
  for (const Level& level : figure.levels) {
    if (!level.vertical) {
      frame["levels"].push_back({{"value", level.value}, {"label", level.label}});
    }
  }
  for (const Shade& shade : figure.shades) {
    frame["shades"].push_back({{"from", shade.from}, {"to", shade.to}, {"colour", shade.colour}});
  }
  std::string text = frame.dump(-1, ' ', false, json::error_handler_t::replace);
  text.pop_back();
  text += ",\"series\":[";
  for (std::size_t i = 0; i < figure.series.size(); ++i) {
    text += (i == 0 ? "" : ",") + seriesText(figure.series[i]);
  }
  return kCurves + harmless(text + "]}") + "</script>\n";
}

std::string scriptElement(std::string_view page) {
  return page.find(kCurves) == std::string_view::npos
             ? std::string()
             : "<script>\n" + std::string(kInteractiveScript) + "</script>\n";
}

}  // namespace patella::report
