#include "tools/bench/diagnose/summary.hpp"

#include <algorithm>

#include <doctest/doctest.h>

using namespace patella;
using namespace patella::bench;

namespace {

CaseResult single(Kind kind, double strength, Outcome outcome, const std::string& found) {
  CaseResult result;
  result.suite = Suite::kSingle;
  result.motion = "multisine";
  result.effects = {{.effect = {.kind = kind}, .strength = strength}};
  result.truth.suite = Suite::kSingle;
  result.truth.effects = {{.kind = std::string(infoOf(kind).name), .joint = 0, .parameters = {}}};
  result.score.outcome = outcome;
  result.score.named_right = outcome == Outcome::kExact || outcome == Outcome::kPair;
  if (!found.empty()) {
    diagnose::EffectFinding finding;
    finding.kind = found;
    result.diagnosis.effects.push_back(finding);
  }
  return result;
}

std::vector<CaseResult> someResults() {
  return {single(Kind::kCoulomb, 3.0, Outcome::kExact, "coulomb_friction"),
          single(Kind::kCoulomb, 2.5, Outcome::kFalse, "viscous_friction"),
          single(Kind::kLag, 0.6, Outcome::kNothing, ""),
          single(Kind::kLag, 4.0, Outcome::kPair, "actuator_delay")};
}

}  // namespace

TEST_CASE("Wilson's interval has its tabled values") {
  const Proportion none{.hits = 0, .cases = 10};
  CHECK(none.low() == 0.0);
  CHECK(none.high() == doctest::Approx(0.2775).epsilon(1e-3));
  const Proportion half{.hits = 5, .cases = 10};
  CHECK(half.low() == doctest::Approx(0.2366).epsilon(1e-3));
  CHECK(half.high() == doctest::Approx(0.7634).epsilon(1e-3));
  const Proportion all{.hits = 10, .cases = 10};
  CHECK(all.low() == doctest::Approx(0.7225).epsilon(1e-3));
  CHECK(all.high() == 1.0);
}

TEST_CASE("power is counted by strength, effects in the span of the nominal parameters left out") {
  std::vector<CaseResult> results = someResults();
  results.push_back(single(Kind::kPayload, 2.6, Outcome::kExact, "payload"));
  results.back().truth.in_span = true;
  const std::vector<Proportion> power = powerCurve(results);
  CHECK(power.front().cases == 1);
  CHECK(power.front().hits == 0);
  CHECK(power[3].cases == 2);
  CHECK(power[3].hits == 1);
  CHECK(power[4].hits == 1);
}

TEST_CASE("a set that holds the truth counts as the truth's own name in the confusion") {
  const Confusion confusion = confusionOf(someResults());
  const auto at = [&](const std::string& truth, const std::string& called) {
    const auto row = std::find(confusion.rows.begin(), confusion.rows.end(), truth) - confusion.rows.begin();
    const auto column =
        std::find(confusion.columns.begin(), confusion.columns.end(), called) - confusion.columns.begin();
    return confusion.count[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)];
  };
  CHECK(at("coulomb_friction", "coulomb_friction") == 1);
  CHECK(at("coulomb_friction", "viscous_friction") == 1);
  CHECK(at("actuator_lag", "actuator_lag") == 1);
  CHECK(at("actuator_lag", "nothing") == 1);
}

TEST_CASE("a diagnosis that fails is a case that is not right") {
  std::vector<CaseResult> results = someResults();
  results[0].error = "no stretch, of 2 s";
  results[0].score = {};
  results[0].score.outcome = Outcome::kFailed;
  CHECK(powerCurve(results)[3].cases == 2);
  CHECK(powerCurve(results)[3].hits == 0);
  CHECK(summaryText(results).find("1 diagnoses failed") != std::string::npos);
}

TEST_CASE("every row of the table has as many cells as its header") {
  std::vector<CaseResult> results = someResults();
  results[1].error = "a, b";
  const std::string header = csvHeader();
  for (const CaseResult& result : results) {
    const std::string row = csvRow(result);
    CHECK(std::count(row.begin(), row.end(), ',') == std::count(header.begin(), header.end(), ','));
  }
}
