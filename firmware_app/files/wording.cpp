#include "firmware_app/files/wording.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <vector>

#include "core/check.hpp"
#include "drivers/joined.hpp"

namespace patella::app {
namespace {

// In half errors, so that a wrong case costs less than a wrong letter.
constexpr std::size_t kError = 2;
constexpr std::size_t kWrongCase = 1;

std::size_t replacementCost(char a, char b) {
  if (a == b) {
    return 0;
  }
  const auto lower = [](char c) { return std::tolower(static_cast<unsigned char>(c)); };
  return lower(a) == lower(b) ? kWrongCase : kError;
}

std::size_t editDistance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) {
    row[j] = j * kError;
  }
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i * kError;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] =
          std::min({above + kError, row[j - 1] + kError, diagonal + replacementCost(a[i - 1], b[j - 1])});
      diagonal = above;
    }
  }
  return row[b.size()];
}

/// One is the other without its unit: "mass" and "mass_kg".
bool lacksUnit(std::string_view a, std::string_view b) {
  const auto begins = [](std::string_view longer, std::string_view shorter) {
    return longer.size() > shorter.size() && longer.starts_with(shorter) && longer[shorter.size()] == '_';
  };
  return !a.empty() && !b.empty() && (begins(a, b) || begins(b, a));
}

}  // namespace

std::string formatNumber(double value) {
  return shortestText(value);
}

void appendFormatted(std::string& text, double value) {
  std::array<char, 32> digits{};
  text.append(digits.data(), std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr);
}

std::string quotedList(std::span<const std::string> names) {
  return joined(names, ", ", [](const std::string& name) { return "'" + name + "'"; });
}

std::string nearestName(std::string_view name, std::span<const std::string> candidates) {
  std::string best;
  // Beyond a third of the letters a suggestion misleads more than it helps.
  std::size_t best_distance = std::max<std::size_t>(name.size() / 3, 2) * kError + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = lacksUnit(name, candidate) ? 1 : editDistance(name, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = candidate;
    }
  }
  return best;
}

std::string suggestion(std::string_view name, std::span<const std::string> candidates) {
  const std::string nearest = nearestName(name, candidates);
  return nearest.empty() ? "" : ", did you mean '" + nearest + "'?";
}

}  // namespace patella::app
