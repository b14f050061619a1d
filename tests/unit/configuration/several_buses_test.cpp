// A run on two buses: what the shipped example comes to, and what is refused, by which words.
#include <array>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/configuration/changed_config.hpp"

using namespace patella;
using namespace patella::app;
using namespace patella::test;

namespace {

/// The shipped example with a place of the run configuration and one of its bus map changed.
RunConfig load(const Change& run, const Change& map, const std::string& backend = "",
               const std::string& faults = "") {
  const ScratchFolder folder;
  std::string map_text = changed(readFile(kShipped / "can/two_buses.toml"), map);
  map_text = changed(map_text, {"\"cia402.dbc\"", "\"" + (kShipped / "can/cia402.dbc").string() + "\""});
  map_text =
      changedEverywhere(map_text, {"\"cia402.eds\"", "\"" + (kShipped / "can/cia402.eds").string() + "\""});
  const std::string text = changed(changed(readFile(kShipped / "two_buses.toml"), run),
                                   {"\"can/two_buses.toml\"", "\"map.toml\""});
  writeFile(folder.path() / "run.toml", withShippedPaths(text));
  writeFile(folder.path() / "map.toml", map_text);
  CommandLine line;
  line.config = folder.path() / "run.toml";
  if (!backend.empty()) {
    line.backend = backend;
  }
  if (!faults.empty()) {
    writeFile(folder.path() / "faults.toml", faults);
    line.faults = folder.path() / "faults.toml";
  }
  return loadRunConfig(line);
}

const Change kNoChange{"# ", "# "};

std::string refusal(const Change& run, const Change& map, const std::string& backend = "",
                    const std::string& faults = "") {
  return messageOf<std::exception>([&] { load(run, map, backend, faults); });
}

constexpr const char* kSecondInterface = "interface = \"can1\"";

}  // namespace

TEST_CASE("two buses: the shipped example has the hip's drive on one, knee and EMG on the other") {
  const RunConfig config = load(kNoChange, kNoChange);
  REQUIRE(config.buses.size() == 2);
  CHECK(config.buses[0].name == "hip");
  CHECK(config.buses[0].interface == "can0");
  CHECK(config.buses[1].bitrate == 1'000'000);
  CHECK(config.loop.buses == 2);
  const auto bus_of = [&](const char* message) { return config.bus.database.message(message).bus; };
  CHECK(bus_of("Drive1Command") == 0);
  CHECK(bus_of("Drive1Report") == 0);
  CHECK(bus_of("Drive2Command") == 1);
  CHECK(bus_of("Drive2Report") == 1);
  CHECK(bus_of("Emg") == 1);
  CHECK(bus_of("Operator") == 1);
  CHECK(config.bus.canopen.drives[0].bus == 0);
  CHECK(config.bus.canopen.drives[1].bus == 1);
  CHECK(config.rig.field_drives[1].bus == 1);
  CHECK(config.rig.buses == 2);
  makeDecoder(config);
  makeEncoder(config);
  makeRig(config);
}

TEST_CASE("two buses: interfaces of the command line come in the order of the buses") {
  const RunConfig swapped = load(kNoChange, kNoChange, "can:vcan1,vcan0");
  CHECK(swapped.buses[0].interface == "vcan1");
  CHECK(swapped.buses[1].interface == "vcan0");
  CHECK(swapped.backend.target == "vcan1,vcan0");
  CHECK(load(kNoChange, kNoChange, "can").backend.target == "can0,can1");
  CHECK(says(refusal(kNoChange, kNoChange, "can:vcan0"), "expected 2 interfaces, one for each [[bus]]"));
  CHECK(says(refusal(kNoChange, kNoChange, "can:vcan0,vcan1,vcan2"), "expected 2 interfaces"));
  CHECK(says(refusal(kNoChange, kNoChange, "can:vcan0,vcan0"),
             "value 'vcan0' for bus 'knee', which is that of bus 'hip'"));
  CHECK(says(refusal(kNoChange, kNoChange, "can:vcan0,"), "value '' for bus 'knee'"));
}

TEST_CASE("two buses: a bus that is not there, or not used, or named twice is refused by name") {
  CHECK(says(refusal(kNoChange, {"bus = \"hip\"", "bus = \"hips\""}),
             "cia402[1].bus': value 'hips', expected a bus of the run configuration: hip, knee"));
  CHECK(says(refusal(kNoChange, {"bus = \"hip\"", "bus = \"knee\""}), "no message travels on bus 'hip'"));
  CHECK(says(refusal({"name = \"knee\"", "name = \"hip\""}, kNoChange), "which is another bus's"));
  CHECK(says(refusal({kSecondInterface, "interface = \"can0\""}, kNoChange),
             "value 'can0' for bus 'knee', which is that of bus 'hip'"));
  CHECK(says(refusal({kSecondInterface, "interface = \"a_name_of_sixteen\""}, kNoChange),
             "at most 15 characters"));
  CHECK(says(refusal({kSecondInterface, ""}, kNoChange), "interface"));
  CHECK(says(refusal({"[estimation]",
                      "[[bus]]\nname = \"a\"\ninterface = \"a\"\n[[bus]]\nname = \"b\"\n"
                      "interface = \"b\"\n[[bus]]\nname = \"c\"\ninterface = \"c\"\n[estimation]"},
                     kNoChange),
             "5 tables, expected 1 to 4"));
}

TEST_CASE("two buses: a message is on one of them, and on which has to be said") {
  CHECK(says(refusal(kNoChange, {"signal = \"Channel2\" }", "signal = \"Channel2\", bus = \"hip\" }"}),
             "message 'Emg' is on bus 'hip', and on bus 'knee' already"));
  CHECK(says(refusal(kNoChange, {"signal = \"Channel1\", bus = \"knee\" }", "signal = \"Channel1\" }"}),
             "nothing says on which bus message 'Emg' travels"));
  CHECK(says(refusal(kNoChange, {"bus = \"hip\"\n", ""}), "message 'Drive1Command' travels"));
}

TEST_CASE("one bus: without a name none may be named, with a name it may be left out") {
  const std::string two = readFile(kShipped / "two_buses.toml");
  const std::size_t begin = two.find("[[bus]]");
  const std::size_t second = two.find("[[bus]]", begin + 1);
  const std::string tables = two.substr(begin, two.find("[estimation]") - begin);
  CHECK(
      says(refusal({tables, "[bus]\nmap = \"map.toml\"\n\n"}, {"# Binds", "# Binds"}), "expected no 'bus'"));
  const std::string only_knee = two.substr(second, two.find("[estimation]") - second);
  const RunConfig config = load({tables, only_knee}, {"bus = \"hip\"\n", ""});
  CHECK(config.buses.size() == 1);
  CHECK(config.bus.database.message("Drive1Report").bus == 0);
  CHECK(says(refusal({tables, only_knee}, kNoChange),
             "value 'hip', expected a bus of the run configuration: knee"));
}

TEST_CASE("two buses: a script of faults strikes one of them, or all") {
  const auto script = [](const std::string& bus) {
    return "[[fault]]\nkind = \"bus_off\"\ntime_s = 1\n" + bus;
  };
  CHECK(load(kNoChange, kNoChange, "", script("bus = \"knee\"\n")).faults[0].bus == 1);
  CHECK(load(kNoChange, kNoChange, "", script("")).faults[0].bus == sim::FaultEvent::kAll);
  CHECK(says(refusal(kNoChange, kNoChange, "", script("bus = \"foot\"\n")), "value 'foot'"));
  CHECK(says(refusal(kNoChange, kNoChange, "",
                     "[[fault]]\nkind = \"rig_stall\"\ntime_s = 1\nduration_s = 1\n"
                     "bus = \"knee\"\n"),
             "bus"));
}

TEST_CASE("a bus needs CAN FD where the loop sends or needs a message of it, and no other bus does") {
  const ScratchFolder folder;
  const auto found = [&](const std::string& fd_id, const std::string& map_name) {
    const std::string dbc = map_name == "patella" ? readFile(checkout::source() / "drivers/can/patella.dbc")
                                                  : readFile(kShipped / "can/cia402.dbc");
    std::string attributes =
        "\nBA_DEF_ BO_ \"VFrameFormat\" ENUM "
        "\"StandardCAN\",\"ExtendedCAN\",\"r2\",\"r3\",\"r4\",\"r5\",\"r6\",\"r7\","
        "\"r8\",\"r9\",\"r10\",\"r11\",\"r12\",\"r13\",\"StandardCAN_FD\",\"ExtendedCAN_FD\";\n"
        "BA_DEF_DEF_ \"VFrameFormat\" \"StandardCAN\";\n";
    if (!fd_id.empty())
      attributes += "BA_ \"VFrameFormat\" BO_ " + fd_id + " 14;\n";
    writeFile(folder.path() / "fd.dbc", dbc + attributes);
    std::string map = readFile(kShipped / "can" / (map_name + ".toml"));
    map = changed(map, map_name == "patella" ? Change{"\"../../../drivers/can/patella.dbc\"", "\"fd.dbc\""}
                                             : Change{"\"cia402.dbc\"", "\"fd.dbc\""});
    for (int drive = 0; map_name != "patella" && drive < 2; ++drive)
      map = changed(map, {"\"cia402.eds\"", "\"" + (kShipped / "can/cia402.eds").string() + "\""});
    writeFile(folder.path() / "map.toml", map);
    const BusNames names =
        map_name == "patella" ? BusNames() : BusNames(std::vector<std::string>{"hip", "knee"});
    const BusDescription bus = loadBusDescription(folder.path() / "map.toml", {}, false, names);
    return std::array{fdMessage(bus, 0), fdMessage(bus, 1)};
  };
  using Found = std::array<std::string, 2>;
  CHECK(found("", "patella") == Found{});
  CHECK(found("128", "patella") == Found{"TorqueCommand", ""});
  CHECK(found("304", "patella") == Found{"Emg", ""});
  CHECK(found("2016", "patella") == Found{});  // the truth
  CHECK(found("304", "two_buses") == Found{"", "Emg"});
}
