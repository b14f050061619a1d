// Rows of ticks.csv as messages, and back.
#include "firmware_app/formats/tick_message.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include "drivers/joined.hpp"
#include "firmware_app/formats/run_messages.hpp"
#include "firmware_app/recorder/tick_record.hpp"

using namespace patella;
using namespace patella::formats;

namespace {

std::vector<std::string> columnsOf(int joints) {
  std::vector<std::string> names;
  for (const app::TickColumn& column : app::tickColumns(joints)) {
    names.push_back(column.name);
  }
  return names;
}

bool sameBits(double a, double b) {
  return (std::isnan(a) && std::isnan(b)) || a == b;
}

}  // namespace

TEST_CASE("numbered columns become arrays with lower-case names") {
  const auto fields =
      tickFields({"t_s", "q1_rad", "q2_rad", "tau_cmd1_Nm", "emg1_mV", "acc_rad_s2", "state"});
  REQUIRE(fields.size() == 6);
  CHECK(fields[1].name == "q_rad");
  CHECK(fields[1].count == 2);
  CHECK(fields[2].name == "tau_cmd_nm");
  CHECK(fields[2].is_array);
  CHECK(fields[4].name == "acc_rad_s2");
  CHECK_FALSE(fields[4].is_array);
  CHECK(fields[5].type == FieldType::kUint8);
  const std::string definition = tickDefinition(fields);
  CHECK(definition.find("float64[2] q_rad\n") != std::string::npos);
  CHECK(definition.find("uint8 STATE_ACTIVE=2\n") != std::string::npos);
}

TEST_CASE("a row comes back from its message to the last bit, for one joint and for two") {
  for (const int joints : {1, 2}) {
    const std::vector<std::string> columns = columnsOf(joints);
    std::vector<double> row;
    for (std::size_t i = 0; i < columns.size(); ++i) {
      row.push_back(static_cast<double>(i) / 3.0);
    }
    for (const char* whole : {"state", "faults", "limits", "encoder_steps", "missed_periods"}) {
      row[static_cast<std::size_t>(std::find(columns.begin(), columns.end(), whole) - columns.begin())] = 5.0;
    }
    row[1] = std::numeric_limits<double>::quiet_NaN();
    row[2] = -std::numeric_limits<double>::denorm_min();
    const auto fields = tickFields(columns);
    CdrWriter message;
    encodeTick(message, fields, row);
    const TickDecoder decoder(tickDefinition(fields), joined(columns, ","));
    CHECK(decoder.columns() == columns);
    std::vector<double> back;
    decoder.decode(message.bytes(), back);
    REQUIRE(back.size() == row.size());
    for (std::size_t i = 0; i < row.size(); ++i) {
      CHECK_MESSAGE(sameBits(back[i], row[i]), columns[i]);
    }
    const auto short_message = message.bytes().substr(0, message.bytes().size() - 1);
    CHECK_THROWS_AS(decoder.decode(short_message, back), std::invalid_argument);
  }
}

TEST_CASE("what is no whole number, and definitions of others, are refused") {
  CdrWriter message;
  const auto fields = tickFields({"t_s", "state"});
  CHECK_THROWS_AS(encodeTick(message, fields, std::vector{0.0, std::nan("")}), std::invalid_argument);
  CHECK_THROWS_AS(encodeTick(message, fields, std::vector{0.0, 256.0}), std::invalid_argument);
  CHECK_THROWS_AS(TickDecoder("string a\n", "a"), std::invalid_argument);
  CHECK_THROWS_AS(TickDecoder("float64[] a\n", "a"), std::invalid_argument);
  CHECK_THROWS_AS(TickDecoder("float64 a\n", "a,b"), std::invalid_argument);
  CHECK_THROWS_AS(RunMessages({"q1_rad"}), std::invalid_argument);
}
