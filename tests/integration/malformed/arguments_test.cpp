// Command lines with one defect each.
#include <algorithm>
#include <array>
#include <ctime>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include "tests/integration/malformed/patella_process.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::test;

TEST_CASE("an argument out of its range") {
  expectRunRefused({
      {"no rate", none(), {"--rate: value 0, expected", "[50, 20000]"}, {"--rate", "0"}},
      {"absurd rate", none(), {"--rate: value 1e+09, expected", "[50, 20000]"}, {"--rate", "1e9"}},
      {"rate that is no number", none(), {"--rate: value nan, expected"}, {"--rate", "nan"}},
      {"unknown backend",
       none(),
       {"--backend: value 'foo', expected sim, can:INTERFACE or replay:LOG"},
       {"--backend", "foo"}},
      {"backend without a target",
       none(),
       {"--backend: value 'can:', expected sim, can:INTERFACE or replay:LOG"},
       {"--backend", "can:"}},
      {"virtual clock on a bus",
       none(),
       {"clock 'virtual'", "can:can0", "expected monotonic"},
       {"--backend", "can:can0"}},
  });
}

namespace {

// Defects of arguments that expectRunRefused() gives itself.
void expectRefusedWith(const std::vector<std::string>& arguments, const std::vector<std::string>& says) {
  const Workshop workshop;
  std::vector<std::string> words = {"run", "--config", workshop.file(kConfig).string(), "--out",
                                    workshop.output().string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  const std::set<std::string> before = workshop.listing();
  const Outcome outcome = workshop.patella(words);
  INFO(outcome.errors);
  CHECK(outcome.signal == 0);
  CHECK(outcome.exit_status == 1);
  for (const std::string& phrase : says) {
    CAPTURE(phrase);
    CHECK(outcome.errors.find(phrase) != std::string::npos);
  }
  CHECK(workshop.listing() == before);
}

}  // namespace

TEST_CASE("a duration that has passed, an unknown clock, a seed below zero") {
  expectRefusedWith({"--duration", "-1"}, {"--duration: value -1, expected", "[0, "});
  expectRefusedWith({"--clock", "sundial"}, {"--clock: value 'sundial', expected monotonic or virtual"});
  expectRefusedWith({"--seed", "-3"}, {"--seed", "-3"});
}

TEST_CASE("an argument that there is not") {
  expectRefusedWith({"--fast"}, {"--fast"});
  expectRefusedWith({"--duration", "ten"}, {"--duration: value 'ten', expected a number"});
  expectRefusedWith({"--rate"}, {"--rate"});
}

TEST_CASE("no configuration, and no command") {
  const Workshop workshop;
  const Outcome run = workshop.patella({"run"});
  CHECK(run.exit_status == 1);
  CHECK(run.errors.find("--config is required") != std::string::npos);
  const Outcome misspelt = workshop.patella({"run", "--confg", "adult.toml"});
  CHECK(misspelt.exit_status == 1);
  CHECK(misspelt.errors.find(
            "--confg: unknown option, expected one that --help names, did you mean '--config'?") !=
        std::string::npos);
  const Outcome bare = workshop.patella({});
  CHECK(bare.exit_status == 1);
  CHECK(bare.errors.find("subcommand is required") != std::string::npos);
  const Outcome unknown = workshop.patella({"replay", "--help"});
  CHECK(unknown.exit_status == 1);
  CHECK(unknown.errors.find("'replay' is no command, expected run, check, bounds or view") !=
        std::string::npos);
}

TEST_CASE("arguments of the simulated rig are refused in the same words") {
  const std::string rig = checkout::build() / "firmware_app/patella-rig";
  const Outcome misspelt = runProgram(rig, {"can:vcan0", "--confg", "adult.toml"});
  CHECK(misspelt.exit_status == 1);
  CHECK(misspelt.errors.find(
            "--confg: unknown option, expected one that --help names, did you mean '--config'?") !=
        std::string::npos);
  const Outcome no_number = runProgram(rig, {"can:vcan0", "--config", "adult.toml", "--seed", "ten"});
  CHECK(no_number.exit_status == 1);
  CHECK(no_number.errors.find("--seed: value 'ten', expected a whole number") != std::string::npos);
}

TEST_CASE("an interface that there is not, to check") {
  const Workshop workshop;
  const Outcome check =
      workshop.patella({"check", "--config", workshop.file(kConfig).string(), "--backend", "can:nosuch0"});
  CHECK(check.exit_status == 1);
}

TEST_CASE("runs of one second have folders of their own, and a refused one leaves none") {
  const Workshop workshop;
  const std::filesystem::path before = std::filesystem::current_path();
  std::filesystem::current_path(workshop.file("."));
  constexpr int kSeconds = 300;  // that the run may take to start
  for (int second = 0; second < kSeconds; ++second) {
    const std::time_t at = std::time(nullptr) + second;
    std::tm local{};
    localtime_r(&at, &local);
    std::array<char, 32> name{};
    std::strftime(name.data(), name.size(), "runs/%Y%m%d-%H%M%S", &local);
    std::filesystem::create_directories(name.data());
    workshop.write(std::string(name.data()) + "/summary.json", "precious");
  }
  const std::vector<std::string> arguments = {
      "run", "--clock", "virtual", "--duration", "0.1", "--config", workshop.file(kConfig).string()};
  const Outcome outcome = workshop.patella(arguments);
  const std::set<std::string> with_it = workshop.listing();
  std::vector<std::string> refused = arguments;
  refused.insert(refused.end(), {"--backend", "can:nosuch0", "--clock", "monotonic"});
  refused.erase(refused.begin() + 1, refused.begin() + 3);
  CHECK(workshop.patella(refused).exit_status == 1);
  std::filesystem::current_path(before);
  INFO(outcome.errors);
  CHECK(outcome.exit_status == 0);
  CHECK(std::ranges::any_of(with_it,
                            [](const std::string& path) { return path.ends_with("-2/summary.json"); }));
  CHECK(workshop.listing() == with_it);
}

TEST_CASE("no name of a folder") {
  expectRefusedWith({"--out", ""}, {"--out: '', expected a folder"});
}

TEST_CASE("no name of a file") {
  for (const std::string option : {"--model", "--rig-model", "--reference", "--weights", "--faults"}) {
    CAPTURE(option);
    expectRefusedWith({option, ""}, {option + ": '', expected a file"});
  }
}

TEST_CASE("an interface that there is not") {
  expectRefusedWith({"--clock", "monotonic", "--backend", "can:nosuch0"}, {"nosuch0"});
  expectRefusedWith(
      {"--clock", "monotonic", "--backend", "can:a_name_longer_than_the_kernel_allows"},
      {"--backend: value 'a_name_longer_than_the_kernel_allows', expected the name of an interface"});
}

TEST_CASE("an output that cannot be created") {
  const Workshop workshop;
  workshop.write("occupied", "a file stands where the folder should be");
  const Outcome outcome =
      workshop.patella({"run", "--clock", "virtual", "--duration", "0.1", "--config",
                        workshop.file(kConfig).string(), "--out", workshop.file("occupied/run").string()});
  INFO(outcome.errors);
  CHECK(outcome.exit_status == 1);
  CHECK(outcome.errors.find("occupied/run: cannot be created: Not a directory") != std::string::npos);
}

TEST_CASE("an output that holds a recording is left as it is") {
  // Whichever file of a run stands there: none of the others is created beside it.
  for (const char* name : {"frames.log", "ticks.csv", "events.log", "summary.json"}) {
    CAPTURE(name);
    const Workshop workshop;
    std::filesystem::create_directory(workshop.output());
    const std::string recording = std::string("out/") + name;
    workshop.write(recording, "precious");
    const std::set<std::string> before = workshop.listing();
    const Outcome outcome =
        workshop.patella({"run", "--clock", "virtual", "--duration", "0.1", "--config",
                          workshop.file(kConfig).string(), "--out", workshop.output().string()});
    INFO(outcome.errors);
    CHECK(outcome.exit_status == 1);
    CHECK(outcome.errors.find("out: holds a recording already (" + std::string(name) + ")") !=
          std::string::npos);
    CHECK(workshop.listing() == before);
    CHECK(workshop.read(recording) == "precious");
  }
}

TEST_CASE("a run shorter than a tick, or longer than any, is refused") {
  expectRefusedWith({"--duration", "0.0004"}, {"--duration: value 4e-04, expected at least a tick", "0.001 s",
                                               "or 0 to run until stopped"});
  expectRefusedWith({"--duration", "9.9e-4"}, {"--duration: value 0.00099, expected at least a tick"});
  expectRefusedWith({"--duration", "2592001"}, {"--duration: value 2592001, expected", "[0, 2592000]"});
  expectRefusedWith({"--duration", "inf"}, {"--duration: value inf, expected", "[0, 2592000]"});
}

TEST_CASE("processors and seeds that there are not") {
  expectRefusedWith({"--cpus", "1024"}, {"--cpus: value 1024, expected", "[0, 1023]"});
  expectRefusedWith({"--cpus", "0,-1"}, {"--cpus: value -1, expected", "[0, 1023]"});
  expectRefusedWith({"--cpus", "1023"},
                    {"realtime.cpus: processor 1023, expected one that this process may use: "});
  expectRefusedWith({"--seed", "-1"}, {"--seed: value -1, expected", "[0, 9007199254740991]"});
  expectRefusedWith({"--seed", "9007199254740993"}, {"--seed: value ", "expected", "[0, 9007199254740991]"});
}

TEST_CASE("what is shorter than a tick cannot be counted in ticks") {
  expectRefused({
      {"stall",
       replaced(kConfig, "duration_s = 12", "stall_tolerated_s = 0.001"),
       {"adult.toml:{line}: key 'loop.stall_tolerated_s': value 0.001, expected more than a tick"},
       {}},
      {"watchdog",
       replaced(kConfig, "rate_Hz = 1000", "rate_Hz = 100\nwatchdog_timeout_s = 0.01"),
       {"adult.toml:", ": key 'loop.watchdog_timeout_s': value 0.01, expected more than a tick"},
       {}},
  });
}

TEST_CASE("a rehearsal is refused where a motor may listen") {
  Workshop workshop;
  workshop.replace(kConfig, "duration_s = 12", "duration_s = 12\nrehearsal = true");
  for (const char* command : {"run", "check"}) {
    std::vector<std::string> arguments = {command, "--config", workshop.file(kConfig).string(), "--backend",
                                          "can:lo"};
    if (command == std::string("run")) {
      arguments.insert(arguments.end(), {"--out", workshop.output().string()});
    }
    const Outcome outcome = workshop.patella(arguments);
    INFO(outcome.errors);
    CHECK(outcome.exit_status == 1);
    CHECK(outcome.errors.find("loop.rehearsal = true on CAN interface lo, expected a virtual one (vcan)") !=
          std::string::npos);
  }
}

TEST_CASE("a host that cannot keep time is refused where it must, and leaves nothing behind") {
  // No host has that many processors: what is required is missing everywhere.
  Workshop workshop;
  workshop.replace(kConfig, "cpus = []", "cpus = [1023]");
  const std::set<std::string> before = workshop.listing();
  const Outcome outcome =
      workshop.patella({"run", "--require-rt", "--duration", "0.1", "--config",
                        workshop.file(kConfig).string(), "--out", workshop.file("new/nested/run").string()});
  INFO(outcome.errors);
  CHECK(outcome.signal == 0);
  CHECK(outcome.exit_status == 1);
  CHECK(outcome.errors.find("1023") != std::string::npos);
  CHECK(workshop.listing() == before);
}
