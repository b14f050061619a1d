// The page, drawn by gnuplot.
#include "tools/diagnose/output/diagnosis_report.hpp"

#include <doctest/doctest.h>

#include "tests/support/count_of.hpp"
#include "tests/unit/diagnose_io/made_up_diagnosis.hpp"

using namespace patella;
using patella::test::countOf;

TEST_CASE("a page says it all and needs nothing beside it") {
  const std::string page = diagnose::diagnosisPage(test::madeUpDiagnosis());
  CHECK(page.starts_with("<!DOCTYPE html>"));
  CHECK(countOf(page, "<svg") == 18);
  CHECK(countOf(page, "</svg>") == 18);
  for (const char* part :
       {"<h1>Missing effect found</h1>",
        "A spring and dry friction on joint 2",
        "level 1.48 [1.42, 1.54] N·m",
        "cannot be told from: presliding hysteresis; viscous friction on joint 1 + torque bias",
        "what would tell: slow reversals",
        "joint 2, with what was found",
        "noise floor",
        "mass_kg.1",
        "ddq1*q1",
        "not identifiable",
        "torque gain on joint 1",
        "Commanded against measured torque",
        "Coulomb friction on joint 2",
        "refused: cross-validation",
        "To look at twice",
        "level &lt;may be&gt; zero",
        "if one is too large, so is the other",
        "12ab",
        "clipped at 12",
        "&lt;run &amp; &quot;log&quot;&gt;"}) {
    CAPTURE(part);
    CHECK(page.find(part) != std::string::npos);
  }
  CHECK(page.find("<run") == std::string::npos);
  CHECK(page.find("src=") == std::string::npos);
  CHECK(page.find("http-equiv") == std::string::npos);
  // In the list, at the effect's parameter, and at the mechanism's.
  CHECK(countOf(page, "<b class=\"mark\"") == 4);
  CHECK(countOf(page, "class=\"curves\"") == 6);
}

TEST_CASE("where the drives rest, no error is relative to their torque") {
  diagnose::Diagnosis diagnosis = test::madeUpPostures();
  CHECK(diagnose::diagnosisPage(diagnosis).find("<td>0.1</td><td>–</td><td>2</td>") != std::string::npos);
  diagnosis.before.train_relative[0] = 1e9;
  CHECK(diagnose::diagnosisPage(diagnosis).find("<td>0.1</td><td>–</td><td>–</td>") != std::string::npos);
}

TEST_CASE("a page of postures, and one of nothing at all") {
  const std::string postures = diagnose::diagnosisPage(test::madeUpPostures());
  CHECK(postures.find("<h1>Nothing is missing</h1>") != std::string::npos);
  CHECK(countOf(postures, "<svg") == 1);
  diagnose::Diagnosis nothing;
  nothing.verdict = diagnose::Verdict::kInsufficientExcitation;
  CHECK(diagnose::diagnosisPage(nothing).find("<h1>The motion is too poor to tell</h1>") !=
        std::string::npos);
}
