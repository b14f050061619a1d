// Correlations in words and colours.
#include "tools/diagnose/output/correlation_table.hpp"

#include <limits>

#include <doctest/doctest.h>

#include "tests/support/count_of.hpp"

using namespace patella::diagnose;
using patella::test::countOf;

namespace {

const Correlations kThree{.parameters = {"mass_kg[2]", "coulomb_friction@1 level_Nm", "payload@2 mass_kg"},
                          .matrix = {{1.0, 0.2, -0.97}, {0.2, 1.0, 0.93}, {-0.97, 0.93, 1.0}}};

}  // namespace

TEST_CASE("strong correlations are said in words, strongest first") {
  CHECK(strongCorrelations(kThree, {}) ==
        std::vector<std::string>{
            "mass [2] and payload on joint 2: mass: -0.970, if one is too large, the other is too small",
            "coulomb friction on joint 1: level and payload on joint 2: mass: 0.930, if one is too large, so "
            "is the "
            "other"});
}

TEST_CASE("the matrix has a row and a column for each parameter, and opposite signs have their colours") {
  const std::string table = correlationTable(kThree, {});
  CHECK(countOf(table, "<tr>") == 4);
  CHECK(countOf(table, "background:") == 6);
  CHECK(countOf(table, "<b>-0.97</b>") == 2);
  CHECK(countOf(table, "<b>") == 4);
  CHECK(table.find("2. coulomb friction on joint 1: level") != std::string::npos);
  CHECK(table.find("Hard to tell apart") != std::string::npos);
}

TEST_CASE("nothing to correlate, nothing strong, nothing known") {
  CHECK(correlationTable({}, {}).empty());
  constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
  const std::string table =
      correlationTable({.parameters = {"a", "b"}, .matrix = {{1.0, kNaN}, {kNaN, kNaN}}}, {});
  CHECK(table.find("No two parameters") != std::string::npos);
  CHECK(table.find("nan") == std::string::npos);
}
