// What every tool refuses of its command line.
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/options/output_file.hpp"
#include "tools/options/run_program.hpp"

using namespace patella;

namespace {

struct Parsed {
  std::uint64_t seed = 1;
  std::string words;
};

Parsed parse(const std::vector<std::string>& arguments) {
  Parsed parsed;
  CLI::App app;
  CLI::App& command = *app.add_subcommand("fit");
  command.add_option("--seed", parsed.seed);
  options::refuseNegative(app);
  std::vector<std::string> reversed(arguments.rbegin(), arguments.rend());
  parsed.words = test::messageOf<CLI::ParseError>([&] { app.parse(reversed); });
  return parsed;
}

}  // namespace

TEST_CASE("a number without a sign is not taken from one with it, nor from one too large") {
  for (const char* text : {"-1", "18446744073709551616", "1.5", "0x10", "one"}) {
    CAPTURE(text);
    const Parsed parsed = parse({"fit", "--seed", text});
    CHECK(parsed.words == "--seed: value '" + std::string(text) + "', expected a whole number from 0");
    CHECK(parsed.seed == 1);
  }
  CHECK(parse({"fit", "--seed", "18446744073709551615"}).seed == 18446744073709551615U);
  CHECK(parse({"fit", "--seed", "0"}).seed == 0);
}

TEST_CASE("a tool does not write over what it reads, by whatever name") {
  const test::ScratchFolder scratch;
  app::writeFile(scratch / "ticks.csv", "t_s\n0\n");
  std::filesystem::create_symlink(scratch / "ticks.csv", scratch / "link.csv");
  const auto refusal = [&](const std::filesystem::path& output) {
    return test::messageOf<std::invalid_argument>(
        [&] { options::requireOther("--out", output, options::filesOfRun(scratch.path())); });
  };
  const std::string wanted = "', which is read from, expected another file";
  CHECK(refusal(scratch / "ticks.csv") == "--out: value '" + (scratch / "ticks.csv").string() + wanted);
  CHECK(refusal(scratch.path() / "." / "ticks.csv").ends_with(wanted));
  CHECK(refusal(scratch / "link.csv").ends_with(wanted));
  CHECK(refusal(scratch / "report.html") == "(nothing was thrown)");
  CHECK(refusal(scratch / "frames.log") == "(nothing was thrown)");
  CHECK(refusal("") == "(nothing was thrown)");
}
