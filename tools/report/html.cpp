#include "tools/report/html.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/report/interactive.hpp"
#include "tools/report/palette.hpp"

namespace patella::report {
namespace {

using nlohmann::json;

constexpr const char* kHead = R"(<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<style>
body { font: 15px/1.45 Helvetica, Arial, sans-serif; color: #222; background: #f4f5f6; margin: 0; }
main { max-width: 1560px; margin: 0 auto; padding: 1.2rem; }
h1 { font-size: 1.5rem; margin: 0 0 1rem; overflow-wrap: anywhere; }
h2 { font-size: 1.1rem; margin: 1.6rem 0 .6rem; }
.figures { display: grid; grid-template-columns: repeat(auto-fill, minmax(min(100%, 36rem), 1fr)); gap: .8rem; }
figure { margin: 0; background: #fff; border: 1px solid #ddd; border-radius: 4px; padding: .3rem; }
figure.wide { grid-column: 1 / -1; }
svg { display: block; width: 100%; height: auto; }
figure.live { position: relative; }
.live > svg:not(.chart) { display: none; }
.chart { cursor: crosshair; touch-action: pan-y; user-select: none; height: 300px; }
.chart text { font-size: 12px; fill: #444; text-anchor: middle; }
.chart .y.tick, .chart text.level { text-anchor: end; }
.chart path { fill: none; }
.chart .grid { stroke: #e8e8e8; }
.chart .frame { stroke: #777; }
.chart path.level { stroke: #b00020; stroke-dasharray: 6 4; }
.chart text.level { fill: #b00020; }
.chart .cursor { stroke: #999; }
.chart .selection { fill: #0072b2; fill-opacity: .15; }
figcaption { padding: .2rem .5rem; }
.key { margin-left: 1rem; white-space: nowrap; }
.key::before { content: ""; display: inline-block; width: 1.1em; height: .2em; margin-right: .35em;
  vertical-align: middle; background: var(--colour); }
.hint { float: right; color: #888; font-size: .85em; }
.values { position: absolute; display: none; pointer-events: none; background: #fffffff0; border: 1px solid #bbb;
  border-radius: 4px; padding: .3rem .6rem; font-size: .85rem; font-variant-numeric: tabular-nums; }
.values.shown { display: block; }
.values .key { margin: 0; }
.tables { columns: 30rem; column-gap: 1rem; }
.group { break-inside: avoid; overflow-x: auto; background: #fff; border: 1px solid #ddd; border-radius: 4px; padding: .5rem .8rem;
  margin: 0 0 .8rem; }
h3 { font-size: .95rem; margin: 0 0 .3rem; color: #0072b2; }
table { border-collapse: collapse; width: 100%; }
td { padding: .12rem .3rem; border-top: 1px solid #eee; vertical-align: top; overflow-wrap: break-word; }
/* Long values give way, and never a column beside them. */
table:not(.grid) td:last-child { overflow-wrap: anywhere; }
td:last-child, .grid td + td, .grid th + th { text-align: right; font-variant-numeric: tabular-nums; }
.words td:last-child { text-align: left; }
.grid td:first-child { white-space: nowrap; }
th { padding: .12rem .3rem; text-align: left; color: #666; font-weight: normal; vertical-align: bottom; }
.verdict { border-left: .5rem solid #9a9a9a; background: #fff; padding: .8rem 1.2rem; }
.verdict h1 { font-size: 2rem; margin: 0 0 .3rem; }
.verdict p { font-size: 1.15rem; margin: .3rem 0; }
.verdict ul { font-size: 1.15rem; margin: .5rem 0; }
.note { color: #666; }
.runaways { background: #fff; border-left: .5rem solid #e69f00; margin-top: .8rem; padding: .3rem 1.2rem; }
.runaways h2 { margin: .4rem 0; }
.runaways ul { list-style: none; margin: .3rem 0; padding: 0; }
.mark { display: inline-block; width: 1.25em; line-height: 1.25em; border-radius: 50%; text-align: center;
  background: #e69f00; color: #fff; font-size: .85em; cursor: help; }
.heat { width: auto; }
.heat td:first-child { white-space: normal; }
.heat td + td, .heat th + th { min-width: 2.6rem; text-align: center; }
.legend span { display: inline-block; padding: 0 .5rem; margin-right: .6rem; }
@media print { body { background: #fff; } figure { break-inside: avoid; } }
</style>
)";

std::string scalarText(const json& value) {
  if (value.is_number_float()) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%.6g", value.get<double>());
    return text.data();
  }
  if (value.is_string()) {
    return value.get<std::string>();
  }
  return value.is_null() ? "–" : value.is_boolean() ? (value.get<bool>() ? "yes" : "no") : value.dump();
}

bool isFlat(const json& value) {
  return !value.is_structured() ||
         (value.is_array() && std::none_of(value.begin(), value.end(),
                                           [](const json& element) { return element.is_structured(); }));
}

std::string flatText(const json& value) {
  if (!value.is_array()) {
    return scalarText(value);
  }
  std::string text;
  for (const json& element : value) {
    text += (text.empty() ? "" : ", ") + scalarText(element);
  }
  return text.empty() ? "none" : text;
}

/// The flat entries of a node as one table under its name, then what is nested in it, each under its own.
void addTables(const std::string& name, const json& node, std::string& page) {
  std::string rows;
  for (const auto& [key, value] : node.items()) {
    if (isFlat(value)) {
      rows += "<tr><td>" + escaped(key) + "</td><td>" + escaped(flatText(value)) + "</td></tr>\n";
    }
  }
  if (!rows.empty()) {
    page += "<div class=\"group\"><h3>" + escaped(name.empty() ? "run" : name) + "</h3>\n<table>\n" + rows +
            "</table></div>\n";
  }
  for (const auto& [key, value] : node.items()) {
    if (!isFlat(value)) {
      // Elements of an array are counted from 1.
      const std::string part = node.is_array() ? std::to_string(std::stoul(key) + 1) : key;
      addTables(name.empty() ? part : name + " › " + part, value, page);
    }
  }
}

/// Says what the shades mean that are there.
std::string shadeLegend(std::span<const Figure> figures) {
  constexpr std::pair<const char*, const char*> kMeanings[] = {
      {colour::kLimitShade, "torque held back by a limit"}, {colour::kFaultShade, "fault"}};
  std::string entries;
  for (const auto& [colour, meaning] : kMeanings) {
    const bool occurs = std::any_of(figures.begin(), figures.end(), [&](const Figure& figure) {
      return std::any_of(figure.shades.begin(), figure.shades.end(),
                         [&](const Shade& shade) { return shade.colour == colour; });
    });
    if (occurs) {
      entries += std::string("<span style=\"background:") + colour + "\">" + meaning + "</span>";
    }
  }
  return entries.empty() ? entries : "<p class=\"legend\">" + entries + "</p>\n";
}

}  // namespace

std::string escaped(std::string_view text) {
  std::string result;
  for (const char c : text) {
    switch (c) {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      default:
        result += c;
    }
  }
  return result;
}

std::string figureSections(std::span<const Figure> figures, std::span<const std::string> pictures) {
  std::string text;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    if (i == 0 || figures[i].section != figures[i - 1].section) {
      text += std::string(i == 0 ? "" : "</div>\n") + "<h2>" + escaped(figures[i].section) +
              "</h2>\n<div class=\"figures\">\n";
    }
    text += std::string("<figure") + (figures[i].wide ? " class=\"wide\"" : "") + ">\n" + pictures[i] +
            (figures[i].zoom ? curveElement(figures[i]) : std::string()) + "</figure>\n";
  }
  return text + (figures.empty() ? "" : "</div>\n");
}

std::string tableText(const Table& table) {
  const auto row = [](const std::vector<std::string>& cells, const std::string& tag,
                      const std::string& mark) {
    std::string text = "<tr>";
    for (std::size_t i = 0; i < cells.size(); ++i) {
      text += "<" + tag + ">" + escaped(cells[i]) + (i == 0 ? mark : "") + "</" + tag + ">";
    }
    return text + "</tr>\n";
  };
  std::string text = "<div class=\"group\"><h3>" + escaped(table.title) + "</h3>\n<table class=\"" +
                     (table.words ? "words" : "grid") + "\">\n" + row(table.header, "th", "");
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    text += row(table.rows[i], "td", i < table.marks.size() ? table.marks[i] : "");
  }
  return text + "</table></div>\n";
}

std::string pageAround(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<title>" + escaped(title) + "</title>\n" + kHead +
         "</head>\n<body>\n<main>\n" + body + "</main>\n" + scriptElement(body) + "</body>\n</html>\n";
}

std::string reportPage(const std::string& title, std::span<const Figure> figures,
                       std::span<const std::string> pictures, const json& summary) {
  std::string body = "<h1>" + escaped(title) + "</h1>\n";
  body += shadeLegend(figures);
  body += figureSections(figures, pictures);
  if (!summary.empty()) {
    body += "<h2>Summary</h2>\n<div class=\"tables\">\n";
    addTables("", summary, body);
    body += "</div>\n";
  }
  return pageAround(title, body);
}

}  // namespace patella::report
