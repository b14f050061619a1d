// Torque that no effect of the library explains, on simulated rigs that share no dynamics with the model.
#include <array>
#include <cstdint>
#include <utility>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/diagnosed_case.hpp"

using namespace patella;
using namespace patella::bench;

TEST_CASE("what is beyond the library is unknown, in the shape that mechanics gives it") {
  const std::array<std::pair<std::uint64_t, const char*>, 6> cases{{{114000199U, "ddq2*q2"},
                                                                    {115000018U, "dq2*q2"},
                                                                    {119000057U, "q1*time"},
                                                                    {117000178U, "q1"},
                                                                    {120000059U, "ddq2*q2"},
                                                                    {124000037U, "q2"}}};
  for (const auto& [seed, variable] : cases) {
    CAPTURE(seed);
    const diagnose::Diagnosis diagnosis = diagnosed(multisine(seed, Suite::kUnknown));
    CHECK(diagnosis.verdict == diagnose::Verdict::kUnknownEffect);
    REQUIRE(!diagnosis.unexplained.empty());
    CHECK(diagnosis.unexplained.front().variable == variable);
  }
}

TEST_CASE("what chance does not bring is not nothing, though it is steady in no effect of the library") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(132000098, Suite::kUnknown));
  CHECK(diagnosis.verdict == diagnose::Verdict::kUnknownEffect);
  REQUIRE(diagnosis.unexplained.size() == 1);
  CHECK(diagnosis.unexplained.front().variable == "q1");
}

TEST_CASE("what is left and is no noise makes all unknown, however much was named") {
  const diagnose::Diagnosis diagnosis = diagnosed(multisine(132000017, Suite::kUnknown));
  CHECK(diagnosis.verdict == diagnose::Verdict::kUnknownEffect);
  REQUIRE(!diagnosis.unexplained.empty());
  CHECK(diagnosis.unexplained.front().joint == 1);
  CHECK(diagnosis.unexplained.front().variable == "q1");
}
