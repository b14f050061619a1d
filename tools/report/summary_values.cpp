#include "tools/report/summary_values.hpp"

#include <array>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "tools/report/reduction.hpp"

namespace patella::report {

const nlohmann::json* findKey(const nlohmann::json& node, const std::string& key) {
  if (node.is_object()) {
    if (const auto found = node.find(key); found != node.end()) {
      return &*found;
    }
  }
  if (node.is_structured()) {
    for (const auto& child : node) {
      if (const nlohmann::json* found = findKey(child, key)) {
        return found;
      }
    }
  }
  return nullptr;
}

std::string quantilesText(std::span<const double> values, const nlohmann::json& summary, const char* key) {
  const nlohmann::json* said = findKey(summary, key);
  const auto number = [&](const char* name, double share) {
    const bool there =
        said != nullptr && said->is_object() && said->contains(name) && (*said)[name].is_number();
    return there ? (*said)[name].get<double>() : percentile(values, share);
  };
  std::array<char, 80> text{};
  std::snprintf(text.data(), text.size(), " (p50 %.1f, p99.9 %.1f, max %.1f µs)", number("p50_us", 0.5),
                number("p99_9_us", 0.999), number("max_us", 1.0));
  return text.data();
}

std::string missingTicks(std::size_t ticks, const nlohmann::json& summary) {
  const auto said = summary.find("ticks");
  if (said == summary.end() || !said->is_number_integer() || *said == ticks) {
    return {};
  }
  return std::to_string(ticks) + " ticks, expected the " + said->dump() +
         " that summary.json beside it has: the file was cut off, or the recorder dropped some";
}

}  // namespace patella::report
