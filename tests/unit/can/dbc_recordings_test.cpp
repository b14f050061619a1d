// Files that other people's tools wrote: all but the three that contradict themselves have to be read.
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <set>
#include <string>

#include <doctest/doctest.h>

#include "drivers/can/dbc.hpp"
#include "drivers/can/signal_codec.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella::can;

namespace {

struct Expected {
  std::size_t messages = 0;
  std::size_t signals = 0;
  std::string error;  ///< from the line number on; empty where the file is read
};

const std::map<std::string, Expected> kExpected = {
    {"BU_BO_REL_.dbc", {1, 1, ""}},
    {"CamelCaseEmpty.dbc", {1, 0, ""}},
    {"add_two_dbc_files_1.dbc", {2, 0, ""}},
    {"attribute_Event.dbc", {1, 1, ""}},
    {"bad_message_length.dbc",
     {0, 0,
      ":40:6: signal 'Signal1' does not fit in message 'Message1': it ends in byte 1, and the message has 1 "
      "byte"}},
    {"bus_comment.dbc", {1, 12, ""}},
    {"bus_comment_bare_out.dbc", {0, 0, ""}},
    {"choices_issue_with_name.dbc", {1, 1, ""}},
    {"cp1252.dbc", {0, 0, ""}},
    {"emc32.dbc", {1, 5, ""}},
    {"empty_ns.dbc", {0, 0, ""}},
    {"fd_test_int.dbc", {4, 4, ""}},
    {"floating_point_use_float.dbc", {3, 4, ""}},
    {"is_in_phys_range.dbc", {2, 4, ""}},
    {"issue_168.DBC", {5, 8, ""}},
    {"issue_184_extended_mux_cascaded_dumped.dbc", {1, 5, ""}},
    {"issue_184_extended_mux_independent_multiplexors_dumped.dbc", {1, 6, ""}},
    {"issue_184_extended_mux_multiple_values_dumped.dbc", {1, 4, ""}},
    {"issue_199_extended.dbc",
     {0, 0, ":45:5: extended identifier 0x7FFFFFFF of message 'DriverDoorStatus' is wider than 29 bits"}},
    {"issue_228.dbc", {2, 5, ""}},
    {"issue_63.dbc", {0, 0, ":40:6: signals 'HtrRes' and 'MaxRes' overlap in message 'AFT1PSI2'"}},
    {"issue_725.dbc", {1, 1, ""}},
    {"j1939.dbc", {2, 2, ""}},
    {"long_names_multiple_relations.dbc", {8, 13, ""}},
    {"message-dlc-zero.dbc", {1, 0, ""}},
    {"mod_name_len_src.dbc", {1, 1, ""}},
    {"motohawk_fd.dbc", {1, 3, ""}},
    {"motohawk_with_comments.dbc", {1, 3, ""}},
    {"multiple_senders.dbc", {1, 1, ""}},
    {"multiplex_2.dbc", {4, 19, ""}},
    {"multiplex_choices.dbc", {3, 29, ""}},
    {"multiplex_dumped.dbc", {1, 12, ""}},
    {"no_signals.dbc", {2, 0, ""}},
    {"padding_bit_order.dbc", {5, 13, ""}},
    {"sig_groups.dbc", {4, 10, ""}},
    {"sig_groups_out.dbc", {4, 10, ""}},
    {"socialledge-written-by-cantools-with-default-sort-signals.dbc", {5, 19, ""}},
    {"socialledge-written-by-cantools.dbc", {5, 19, ""}},
    {"test_extended_id_dump.dbc", {2, 2, ""}},
    {"timing.dbc", {2, 2, ""}},
    {"variable_dlc.dbc", {2, 8, ""}},
    {"vframeformat_int.dbc", {2, 2, ""}},
};

const std::filesystem::path kFolder = patella::checkout::recordings() / "can" / "dbc";

Frame frameOf(std::initializer_list<std::uint8_t> bytes) {
  Frame frame;
  for (const std::uint8_t byte : bytes)
    frame.data[frame.length++] = byte;
  return frame;
}

double decode(const Message& message, const char* signal, const Frame& frame) {
  return CompiledSignal(message, *message.find(signal)).decode(frame);
}

}  // namespace

TEST_CASE("each file is read in full, or refused at the line that is wrong") {
  std::set<std::string> seen;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    const std::string name = entry.path().filename().string();
    if (!name.ends_with(".dbc") && !name.ends_with(".DBC"))
      continue;
    CAPTURE(name);
    seen.insert(name);
    REQUIRE(kExpected.count(name) == 1);
    const Expected& expected = kExpected.at(name);
    if (!expected.error.empty()) {
      CHECK_THROWS_WITH_AS(loadDbc(entry.path()), (entry.path().string() + expected.error).c_str(), DbcError);
      continue;
    }
    const Database database = loadDbc(entry.path());
    std::size_t signals = 0;
    for (const Message& message : database.messages)
      signals += message.signals.size();
    CHECK(database.messages.size() == expected.messages);
    CHECK(signals == expected.signals);
  }
  CHECK(seen.size() == kExpected.size());
}

TEST_CASE("Windows-1252 comments and units become UTF-8") {
  const Database database = loadDbc(kFolder / "cp1252.dbc");
  CHECK(database.nodes == std::vector<std::string>{"Node1"});
}

TEST_CASE("frame formats, senders and comments are taken from their statements") {
  const Database vehicle = loadDbc(kFolder / "issue_168.DBC");
  const Message& fd = vehicle.message("CanFd");
  CHECK(fd.fd);
  CHECK(fd.length == 64);
  CHECK_FALSE(vehicle.message("FOOBAR").fd);
  CHECK(vehicle.message("Bar").senders == std::vector<std::string>{"FOO", "BAR"});
  CHECK(vehicle.message("Fum").cycle_time_s == 0.001);
  CHECK(vehicle.message("Foo").cycle_time_s == 0.1);
  CHECK(vehicle.message("Foo").find("Bar")->type == ValueType::kFloat32);
  CHECK(vehicle.message("Foo").find("Bar")->comment == "Bar.");
  CHECK(vehicle.message("Fum").find("Fam")->value_names.at(1) == "Enabled");

  const Database formats = loadDbc(kFolder / "fd_test_int.dbc");
  CHECK(formats.message("TestMsg_FDStd").fd);
  CHECK(formats.message("TestMsg_FDEx").fd);
  CHECK(formats.message("TestMsg_FDEx").bit_rate_switch);
  CHECK_FALSE(formats.message("TestMsg_Std").fd);
  CHECK_FALSE(formats.message("TestMsg_Ex").fd);
  // Ten bytes by J1939 transport, not one CAN FD frame.
  CHECK_FALSE(loadDbc(kFolder / "variable_dlc.dbc").message("TestMessage2").fd);
}

TEST_CASE("messages decode as their authors' tools decode them") {
  const Database motohawk = loadDbc(kFolder / "motohawk_with_comments.dbc");
  const Message& example = motohawk.message("ExampleMessage");
  const Frame frame = frameOf({0xC0, 0x06, 0xE0, 0, 0, 0, 0, 0});
  CHECK(decode(example, "Temperature", frame) == doctest::Approx(250.55));
  CHECK(decode(example, "AverageRadius", frame) == doctest::Approx(3.2));
  CHECK(decode(example, "Enable", frame) == 1.0);

  const Database padding = loadDbc(kFolder / "padding_bit_order.dbc");
  const Frame first = frameOf({0x80, 0x00, 0, 0, 0x80, 0x01, 0, 0});
  CHECK(decode(padding.message("MSG0"), "B", first) == 1.0);
  CHECK(decode(padding.message("MSG0"), "A", first) == 0.0);
  CHECK(decode(padding.message("MSG0"), "C", first) == 1.0);
  const Frame second = frameOf({0x03, 0x80, 0, 0, 0xFE, 0xFF, 0, 0});
  CHECK(decode(padding.message("MSG1"), "E", second) == 1.0);
  CHECK(decode(padding.message("MSG1"), "F", second) == 16385.0);
  CHECK(decode(padding.message("MSG1"), "H", second) == 32767.0);

  const Database floats = loadDbc(kFolder / "floating_point_use_float.dbc");
  const Frame halves = frameOf({0, 0, 0x80, 0x3F, 0, 0, 0, 0xC0});
  CHECK(decode(floats.message("Message2"), "Signal1", halves) == 1.0);
  CHECK(decode(floats.message("Message2"), "Signal2", halves) == -2.0);
}

TEST_CASE("multiplexors are those that the extended statements name") {
  const Database cascaded = loadDbc(kFolder / "issue_184_extended_mux_cascaded_dumped.dbc");
  const Message& message = cascaded.message("ext_MUX_cascaded");
  CHECK(message.find("muxed_B_1")->multiplexor == "muxed_A_2_MUX_B");
  CHECK(message.find("muxed_A_2_MUX_B")->multiplexor == "MUX_A");
  CHECK(message.find("MUX_A")->multiplexor.empty());
  const Frame frame = frameOf({2, 1, 10, 20, 0, 0, 0, 0});
  CHECK(decode(message, "muxed_B_1", frame) == 20.0);
  CHECK(std::isnan(decode(message, "muxed_B_0", frame)));
  CHECK(std::isnan(decode(message, "muxed_A_1", frame)));

  const Database several = loadDbc(kFolder / "issue_184_extended_mux_multiple_values_dumped.dbc");
  const Message& multiple = several.message("ext_MUX_multiple_values");
  for (const std::uint8_t selector : std::initializer_list<std::uint8_t>{0, 3, 4, 5}) {
    CHECK(decode(multiple, "muxed_0_3_4_5", frameOf({selector, 7, 0, 0, 0, 0, 0, 0})) == 7.0);
  }
  CHECK(std::isnan(decode(multiple, "muxed_0_3_4_5", frameOf({6, 7, 0, 0, 0, 0, 0, 0}))));
}
