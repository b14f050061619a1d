// Rankings and intervals.
#include "tools/diagnose/output/selection_figures.hpp"

#include <algorithm>

#include <doctest/doctest.h>

#include "tests/unit/diagnose_io/made_up_diagnosis.hpp"

using namespace patella;
using namespace patella::diagnose;

TEST_CASE("each step has its ranking with what chance reaches") {
  const auto figures = selectionFigures(test::madeUpDiagnosis());
  REQUIRE(figures.size() == 4);
  const report::Figure& first = figures[0];
  CHECK(first.title == "Step 1: linear stiffness on joint 2 accepted, p = 0.002");
  REQUIRE(first.bars.size() == 5);
  CHECK(first.log_x);
  CHECK(first.bars[0].to == 2100.0);
  CHECK(first.bars[0].colour != first.bars[1].colour);
  CHECK(first.bars[1].colour != first.bars[4].colour);
  CHECK(first.row_marks[0].at == 9.5);
  CHECK(first.row_notes[0].text == "2100  accepted");
  CHECK(first.row_notes[3].text == "31  refused: sign: level_Nm");
  CHECK(first.x_range->second > 2100.0);
  CHECK(figures[2].title == "Step 3: none accepted");
  CHECK_FALSE(figures[2].log_x);
}

TEST_CASE("a long ranking is cut, and says so") {
  Diagnosis diagnosis;
  diagnosis.steps.resize(1);
  diagnosis.steps[0].ranking.resize(
      30, {.label = "payload@1", .gain = 3.0, .threshold = 9.0, .refused_because = {}});
  const auto figures = selectionFigures(diagnosis);
  REQUIRE(figures.size() == 1);
  CHECK(figures[0].rows.size() == 12);
  CHECK(figures[0].x_label.find("18 weaker ones left out") != std::string::npos);
}

TEST_CASE(
    "intervals are relative to the estimate, and the end of the physical range shows where it is near") {
  Diagnosis diagnosis = test::madeUpDiagnosis();
  const report::Figure far = selectionFigures(diagnosis).back();
  REQUIRE(far.rows.size() == 3);
  CHECK(far.rows[2] == "coulomb friction on joint 2: level");
  CHECK(far.bars[2].from == doctest::Approx(-4.054).epsilon(0.01));
  CHECK(far.bars[2].to == doctest::Approx(4.054).epsilon(0.01));
  CHECK(far.row_marks.size() == 3);
  CHECK(far.row_notes[2].text == "1.48 [1.42, 1.54] N·m   (physical: 0 … 200)");
  // An estimate whose interval reaches below zero, where no friction is.
  diagnosis.effects[1].parameters[0] = {.name = "level_Nm", .value = 0.1, .ci95 = {-0.02, 0.22}};
  const report::Figure near = selectionFigures(diagnosis).back();
  CHECK(std::count_if(near.row_marks.begin(), near.row_marks.end(), [](const report::RowMark& mark) {
          return mark.row == 2 && mark.at == doctest::Approx(-100.0);
        }) == 1);
}

TEST_CASE("an estimate of zero, and one without an interval, can be drawn") {
  Diagnosis diagnosis = test::madeUpDiagnosis();
  diagnosis.effects[0].parameters[0] = {.name = "stiffness_Nm_rad", .value = 0.0, .ci95 = {-0.1, 0.1}};
  diagnosis.effects[1].parameters[0] = {.name = "level_Nm", .value = 0.0, .ci95 = {0.0, 0.0}};
  const report::Figure figure = selectionFigures(diagnosis).back();
  for (const report::Bar& bar : figure.bars) {
    CHECK(bar.from >= figure.x_range->first);
    CHECK(bar.to <= figure.x_range->second);
  }
}
