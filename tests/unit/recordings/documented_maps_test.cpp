// The examples of docs/column_maps.md are maps and models.
#include <set>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "tools/checkout/checkout.hpp"
#include "tools/recordings/column_map.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

std::vector<std::string> examples() {
  const std::string text = app::readFile(checkout::source() / "docs/column_maps.md");
  const std::string open = "```toml\n";
  std::vector<std::string> found;
  for (auto at = text.find(open); at != std::string::npos; at = text.find(open, at)) {
    at += open.size();
    found.push_back(text.substr(at, text.find("```", at) - at));
  }
  return found;
}

}  // namespace

TEST_CASE("every documented example is read") {
  int maps = 0, models = 0;
  for (const std::string& example : examples()) {
    CAPTURE(example);
    if (example.starts_with("[mechanism]")) {
      ++models;
      CHECK(app::parseModel(example, "model.toml").joints() == 2);
    } else {
      ++maps;
      CHECK(parseColumnMap(example, "map.toml").joints.size() == 1);
    }
  }
  CHECK(maps == 8);
  CHECK(models == 1);
}

TEST_CASE("every unit is documented") {
  const std::string text = app::readFile(checkout::source() / "docs/column_maps.md");
  for (const Quantity quantity : {Quantity::kTime, Quantity::kPosition, Quantity::kVelocity,
                                  Quantity::kTorque, Quantity::kEmg, Quantity::kActivation}) {
    REQUIRE_FALSE(unitsOf(quantity).empty());
    CHECK(unitsOf(quantity).front().factor == 1.0);
    std::set<std::string> names;
    for (const Unit& unit : unitsOf(quantity)) {
      CAPTURE(unit.name);
      CHECK(names.insert(unit.name).second);
      CHECK(text.find("`" + std::string(unit.name) + "`") != std::string::npos);
    }
  }
}
