#include "drivers/can/dbc.hpp"

#include <ctime>
#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "tools/checkout/checkout.hpp"

using namespace patella::can;

namespace {

/// What would take hours without a limit takes less of the processor's time, under emulation and sanitizers
/// too.
const std::clock_t kNotSlow = 60 * CLOCKS_PER_SEC;

/// The located message with which a description is refused; empty where it is read.
std::string errorOf(const std::string& text) {
  try {
    parseDbc(text, "x.dbc");
  } catch (const DbcError& error) {
    return error.what();
  }
  return {};
}

std::string inMessage(const std::string& signals, const std::string& rest = "") {
  return "BU_: N\nBO_ 1 M: 8 N\n" + signals + "\n" + rest;
}

}  // namespace

TEST_CASE("the rig's own description is read as it is written") {
  const Database database = loadDbc(patella::checkout::source() / "drivers/can/patella.dbc");
  CHECK(database.version == "1");
  CHECK(database.nodes == std::vector<std::string>{"Controller", "Rig"});
  CHECK(database.messages.size() == 7);
  const Message& command = database.message("TorqueCommand");
  CHECK(command.id == 128);
  CHECK_FALSE(command.extended);
  CHECK_FALSE(command.fd);
  CHECK(command.cycle_time_s == 0.001);
  CHECK(command.senders == std::vector<std::string>{"Controller"});
  CHECK(command.find("State")->value_names.at(2) == "active");
  CHECK(command.find("State")->comment == "0 init, 1 ready, 2 active, 3 limited, 4 fault.");
  const Signal& position = *database.message("Encoder1").find("Position");
  CHECK(position.start_bit == 0);
  CHECK(position.length == 24);
  CHECK(position.is_signed);
  CHECK(position.byte_order == ByteOrder::kIntel);
  CHECK(position.factor == 1e-6);
  CHECK(position.minimum == -8.388608);
  CHECK(position.unit == "rad");
  CHECK(database.message("Truth").find("Fu2")->type == ValueType::kFloat32);
  CHECK_FALSE(database.message("Truth").cycle_time_s.has_value());
  CHECK(database.find(272, false) == &database.message("Encoder1"));
  CHECK(database.find(272, true) == nullptr);
}

TEST_CASE("a missing message is named together with those that exist") {
  const Database database = parseDbc("BO_ 1 One: 8 N\nBO_ 2 Two: 8 N\n", "rig.dbc");
  CHECK_THROWS_WITH_AS(database.message("Three"), "rig.dbc: no message 'Three'; there are: One, Two",
                       std::invalid_argument);
}

TEST_CASE("malformed text is refused where it stands, with what was found and expected") {
  CHECK(errorOf("BO_ one M: 8 N\n") == "x.dbc:1:5: found 'one', expected a message identifier");
  CHECK(errorOf("BO_ 1 M 8 N\n") == "x.dbc:1:9: found '8', expected ':'");
  CHECK(errorOf("BO_ 1 M: 8\n") == "x.dbc:2:1: found the end of the file, expected the sender's name");
  CHECK(errorOf("BO_ 1 M: 2000 N\n").starts_with("x.dbc:1:10: '2000' is too large"));
  CHECK(errorOf("\n  BANANA_ 1;\n") ==
        "x.dbc:2:3: found 'BANANA_', expected a statement such as BO_, CM_ or VAL_");
  CHECK(errorOf(" SG_ S : 0|8@1+ (1,0) [0|0] \"\" N\n").starts_with("x.dbc:1:2: found 'SG_' outside"));
  CHECK(errorOf("CM_ \"open") == "x.dbc:1:5: string is not closed before the end of the file");
  CHECK(errorOf("CM_ \"no end\"\nBU_: N\n") == "x.dbc:2:1: found 'BU_', expected ';'");
  CHECK(errorOf("EV_ Name: 1 [0|2] \"W\" 0 1 X Y").ends_with("found the end of the file, expected ';'"));
  CHECK(
      errorOf(inMessage(" SG_ S : 0|8@2+ (1,0) [0|0] \"\" N")).starts_with("x.dbc:3:14: expected the byte"));
  CHECK(errorOf(inMessage(" SG_ S : 0|8@1 (1,0) [0|0] \"\" N")) ==
        "x.dbc:3:16: found '(', expected '+' (unsigned) or '-' (signed)");
  CHECK(errorOf(inMessage(" SG_ S : 0|0@1+ (1,0) [0|0] \"\" N")) == "x.dbc:3:12: signal 'S' has no bits");
  CHECK(errorOf(inMessage(" SG_ S x3 : 0|8@1+ (1,0) [0|0] \"\" N"))
            .starts_with("x.dbc:3:8: found 'x3', expected ':' or a multiplexing indicator"));
  CHECK(errorOf(inMessage(" SG_ S : 0|8@1+ (1.2.3,0) [0|0] \"\" N")) ==
        "x.dbc:3:18: '1.2.3' is no number, expected the factor");
  CHECK(errorOf(inMessage(" SG_ S : 0|8@1+ (1,0) [0|0] N")) ==
        "x.dbc:3:29: found 'N', expected the unit in quotes");
  CHECK(errorOf("VAL_ 1 S 1 one ;") == "x.dbc:1:12: found 'one', expected the value's name in quotes");
  CHECK(errorOf("BA_DEF_ BO_ \"A\" WORD 1;").starts_with("x.dbc:1:17: found 'WORD', expected INT"));
}

TEST_CASE("what contradicts itself is refused") {
  const std::string at0 = " : 0|8@1+ (1,0) [0|0] \"\" N\n";
  const std::string at8 = " : 8|8@1+ (1,0) [0|0] \"\" N\n";
  CHECK(errorOf("BO_ 2048 M: 8 N\n") ==
        "x.dbc:1:5: standard identifier 0x800 of message 'M' is wider than 11 bits");
  CHECK(errorOf("BO_ 3758096384 M: 8 N\n").find("wider than 29 bits") != std::string::npos);
  CHECK(errorOf("BO_ 1 A: 8 N\nBO_ 1 B: 8 N\n") ==
        "x.dbc:2:5: messages 'A' and 'B' share the identifier 0x1");
  CHECK(errorOf("BO_ 1 A: 8 N\nBO_ 2147483649 B: 8 N\n").empty());
  CHECK(errorOf("BO_ 1 A: 8 N\nBO_ 2 A: 8 N\n") == "x.dbc:2:7: a message 'A' is defined already");
  CHECK(errorOf(inMessage(" SG_ S" + at0 + " SG_ S" + at8)) ==
        "x.dbc:4:6: signal 'S' occurs twice in message 'M'");
  CHECK(errorOf(inMessage(" SG_ A" + at0 + " SG_ B : 7|2@1+ (1,0) [0|0] \"\" N")) ==
        "x.dbc:4:6: signals 'A' and 'B' overlap in message 'M'");
  // Motorola bits 3..0 of byte 0 and 7..4 of byte 1 against the whole of byte 1.
  CHECK(errorOf(inMessage(" SG_ A : 3|8@0+ (1,0) [0|0] \"\" N\n SG_ B" + at8)).find("overlap") !=
        std::string::npos);
  CHECK(errorOf(inMessage(" SG_ A : 3|4@0+ (1,0) [0|0] \"\" N\n SG_ B" + at8)).empty());
  CHECK(errorOf(inMessage(" SG_ A : 57|8@1+ (1,0) [0|0] \"\" N")).find("does not fit") != std::string::npos);
  CHECK(errorOf(inMessage(" SG_ A : 56|8@0+ (1,0) [0|0] \"\" N")).find("does not fit") != std::string::npos);
  CHECK(errorOf(inMessage(" SG_ A" + at0, "SIG_VALTYPE_ 1 A : 1;")).find("its length is 8") !=
        std::string::npos);
  CHECK(errorOf(inMessage(" SG_ A" + at0, "SIG_VALTYPE_ 1 B : 1;")) ==
        "x.dbc:5:16: message 'M' has no signal 'B'");
  CHECK(errorOf("SIG_VALTYPE_ 1 B : 1;") == "x.dbc:1:14: no message has this identifier");
  CHECK(errorOf(inMessage(" SG_ A : 0|8@1+ (1,0) [5|3] \"\" N")).find("minimum above") != std::string::npos);
}

TEST_CASE("multiplexing has to be complete, free of circles, and excuses overlaps only where it excludes") {
  const std::string mux = " SG_ X M : 0|4@1+ (1,0) [0|0] \"\" N\n";
  const std::string one = " SG_ A m1 : 8|8@1+ (1,0) [0|0] \"\" N\n";
  CHECK(errorOf(inMessage(one)).find("has 0 multiplexors") != std::string::npos);
  CHECK(errorOf(inMessage(mux + one + " SG_ B m2 : 8|8@1+ (1,0) [0|0] \"\" N")).empty());
  CHECK(errorOf(inMessage(mux + one + " SG_ B m1 : 8|8@1+ (1,0) [0|0] \"\" N")).find("overlap") !=
        std::string::npos);
  CHECK(errorOf(inMessage(mux + one + " SG_ B : 8|8@1+ (1,0) [0|0] \"\" N")).find("overlap") !=
        std::string::npos);
  CHECK(errorOf(inMessage(mux + one, "SG_MUL_VAL_ 1 A A 1-1;")).find("no multiplexor") != std::string::npos);
  CHECK(errorOf(inMessage(mux + one, "SG_MUL_VAL_ 1 A X 3-1;")).find("ends before it begins") !=
        std::string::npos);
  const std::string circle =
      " SG_ P m1M : 0|4@1+ (1,0) [0|0] \"\" N\n SG_ Q m1M : 4|4@1+ (1,0) [0|0] \"\" N\n";
  CHECK(errorOf(inMessage(circle, "SG_MUL_VAL_ 1 P Q 1-1;\nSG_MUL_VAL_ 1 Q P 1-1;"))
            .find("selected by itself") != std::string::npos);
}

TEST_CASE("odd but legal text is read") {
  CHECK(errorOf("").empty());
  CHECK(errorOf("\xEF\xBB\xBFVERSION \"1\" // trailing\r\nBS_: 500000:1,2\r\n").empty());
  const Database database = parseDbc(
      "BU_:\nBO_ 3221225472 VECTOR__INDEPENDENT_SIG_MSG: 0 Vector__XXX\n"
      " SG_ Lost : 0|8@1+ (1,0) [0|0] \"\" Vector__XXX\n"
      "BO_ 7 M : 8 N\n SG_ S : 0|8@1- (+1e+0,-2.5E-001) [-1|1.5] \"\xB0"
      "C\" A, B\n"
      "CM_ SG_ 7 S \"said \\\"so\\\"\";\nCM_ BO_ 99 \"of nothing\";\n"
      "VAL_ 7 S -1 \"minus\" 18446744073709551615 \"huge\" ;\n",
      "odd.dbc");
  REQUIRE(database.messages.size() == 1);
  const Signal& signal = database.messages[0].signals[0];
  CHECK(signal.unit ==
        "\xC2\xB0"
        "C");
  CHECK(signal.offset == -0.25);
  CHECK(signal.receivers == std::vector<std::string>{"A", "B"});
  CHECK(signal.comment == "said \"so\"");
  CHECK(signal.value_names.at(-1) == "huge");
}

TEST_CASE("a file that cannot be read is named") {
  CHECK_THROWS_WITH_AS(loadDbc("/nonexistent/bus.dbc"),
                       "/nonexistent/bus.dbc: cannot be opened: No such file or directory", DbcError);
  CHECK_THROWS_AS(loadDbc("/"), DbcError);
}

TEST_CASE(
    "descriptions that would take hours to compare are refused, and the largest that are read are not slow") {
  const auto multiplexed = [](int id, int signals) {
    std::string text = "BO_ " + std::to_string(id) + " M" + std::to_string(id) +
                       ": 8 N\n SG_ Which M : 0|16@1+ (1,0) [0|0] \"\" N\n";
    for (int i = 1; i < signals; ++i)
      text += " SG_ S" + std::to_string(i) + " m" + std::to_string(i) + " : 16|8@1+ (1,0) [0|0] \"\" N\n";
    return text;
  };
  std::string large;
  for (int id = 0; id < 20; ++id)
    large += multiplexed(id, 1024);
  const std::clock_t start = std::clock();
  CHECK(parseDbc(large, "x.dbc").messages.size() == 20);
  CHECK(std::clock() - start < kNotSlow);
  CHECK(errorOf(multiplexed(1, 1025)).find("more than 1024 signals of a message, expected at most 1024") !=
        std::string::npos);

  std::string many;
  for (int id = 0; id <= 20'000; ++id)
    many += "BO_ " + std::to_string(2147483648U + static_cast<unsigned>(id)) + " M" + std::to_string(id) +
            ": 8 N\n";
  CHECK(errorOf(many).find("more than 20000 messages, expected at most 20000") != std::string::npos);

  std::string cascade = "BO_ 1 M: 64 N\n SG_ S0 M : 0|8@1+ (1,0) [0|0] \"\" N\n";
  std::string selected;
  for (int i = 1; i <= 9; ++i) {
    cascade +=
        " SG_ S" + std::to_string(i) + " m0M : " + std::to_string(8 * i) + "|8@1+ (1,0) [0|0] \"\" N\n";
    selected += "SG_MUL_VAL_ 1 S" + std::to_string(i) + " S" + std::to_string(i - 1) + " 0-0;\n";
  }
  CHECK(errorOf(cascade + selected).find("more than 8 multiplexors select signal 'S9'") != std::string::npos);
}

TEST_CASE(
    "two multiplexors with thousands of ranges, and hundreds of signals below each, are compared at once") {
  std::string signals = "BO_ 1 M: 8 N\n SG_ Root M : 0|16@1+ (1,0) [0|0] \"\" N\n";
  std::string ranges;
  for (const int parity : {0, 1}) {
    const std::string name = parity == 0 ? "Even" : "Odd";
    signals += " SG_ " + name + " m0M : 16|16@1+ (1,0) [0|0] \"\" N\n";
    ranges += "SG_MUL_VAL_ 1 " + name + " Root";
    for (int value = parity; value < 18'000; value += 2)
      ranges += (value < 2 ? " " : ", ") + std::to_string(value) + "-" + std::to_string(value);
    ranges += ";\n";
    for (int i = 0; i < 400; ++i) {
      const std::string below = name + std::to_string(i);
      signals += " SG_ " + below + " m0 : 32|8@1+ (1,0) [0|0] \"\" N\n";
      ranges +=
          "SG_MUL_VAL_ 1 " + below + " " + name + " " + std::to_string(i) + "-" + std::to_string(i) + ";\n";
    }
  }
  const std::clock_t start = std::clock();
  CHECK(parseDbc(signals + ranges, "x.dbc").messages.front().signals.size() == 803);
  CHECK(std::clock() - start < kNotSlow);
}
