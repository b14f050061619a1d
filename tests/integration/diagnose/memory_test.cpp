// Memory of long recordings. An hour is out of reach of a test; that ten minutes take hardly more than two
// tells as much.
#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/integration/diagnose/diagnose_process.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella;
using namespace patella::test;

namespace {

/// Outcome of the diagnosis of a knee that rubs. Tremors are considered, since it is their frequencies whose
/// number depends on the recording's length.
Outcome diagnosed(const std::string& csv) {
  const ScratchFolder folder;
  app::writeFile(folder / "knee.csv", csv);
  app::writeFile(folder / "knee.toml", kneeModel());
  Outcome outcome = diagnose({"--model", (folder / "knee.toml").string(), "--data",
                              (folder / "knee.csv").string(), "--out", (folder / "out").string(), "--effects",
                              "coulomb_friction,viscous_friction,tremor", "--replicates", "299"});
  CAPTURE(outcome.errors);
  REQUIRE(outcome.exit_status == 0);
  CHECK(outcome.output.find("coulomb friction on joint 1: level 0.") != std::string::npos);
  return outcome;
}

}  // namespace

TEST_CASE("ten minutes take little more memory than two, and what was analysed of them is said") {
  const Outcome two = diagnosed(kneeCsv(0.4, 120.0));
  const Outcome ten = diagnosed(kneeCsv(0.4, 600.0));
  CHECK(ten.peak_MB < 2.0 * two.peak_MB);
  CHECK(ten.peak_MB < 400.0);
  CHECK(ten.output.find("of 600 s, 10 stretches of 15 s are analysed") != std::string::npos);
  CHECK(two.output.find("are analysed") == std::string::npos);
}

TEST_CASE("stamps of a wall clock cost nothing") {
  const Outcome zero = diagnosed(kneeCsv(0.4, 20.0));
  const Outcome clock = diagnosed(kneeCsv(0.4, 20.0, 1.7e9));
  CHECK(clock.peak_MB < 1.2 * zero.peak_MB);
}
