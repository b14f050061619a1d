// docs/safety.md says what the code does: its table of transitions is the code's, and every fault and warning
// has its row.
#include <array>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "core/safety/state_machine.hpp"
#include "core/safety/warning.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella::safety;

namespace {

const std::vector<std::string>& document() {
  static const std::vector<std::string> lines = [] {
    std::ifstream stream(patella::checkout::source() / "docs/safety.md");
    std::vector<std::string> read;
    for (std::string line; std::getline(stream, line);) {
      read.push_back(line);
    }
    return read;
  }();
  return lines;
}

// In the order of Condition.
constexpr std::array<std::string_view, 8> kConditions = {
    "urgent fault",   "fault of any other kind", "limit fault",     "inputs lost",
    "inputs healthy", "enable raised",           "enable released", "reset raised"};

std::string row(const Transition& transition) {
  return "| " + std::string(stateName(transition.from)) + " | " +
         std::string(kConditions[static_cast<std::size_t>(transition.when)]) + " | " +
         std::string(stateName(transition.to)) + " |";
}

bool mentions(std::string_view name) {
  const std::string quoted = "`" + std::string(name) + "`";
  for (const std::string& line : document()) {
    if (line.starts_with("|") && line.find(quoted) != std::string::npos) {
      return true;
    }
  }
  return false;
}

}  // namespace

TEST_CASE("the documented table of modes and transitions is the one that the code reads") {
  std::vector<std::string> documented;
  bool inside = false;
  for (const std::string& line : document()) {
    if (line == "| from | when | to |") {
      inside = true;
    } else if (inside && !line.starts_with("|")) {
      break;
    } else if (inside && line.find("---") == std::string::npos) {
      documented.push_back(line);
    }
  }
  std::vector<std::string> coded;
  for (const Transition& transition : kTransitions) {
    coded.push_back(row(transition));
  }
  CHECK(documented == coded);
}

TEST_CASE("every fault and every warning has a row in the documentation") {
  for (int i = 0; i < kFaultCount; ++i) {
    CAPTURE(faultName(static_cast<Fault>(i)));
    CHECK(mentions(faultName(static_cast<Fault>(i))));
  }
  for (int i = 0; i < kWarningCount; ++i) {
    CAPTURE(warningName(static_cast<Warning>(i)));
    CHECK(mentions(warningName(static_cast<Warning>(i))));
  }
}
