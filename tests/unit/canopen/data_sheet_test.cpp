// Electronic data sheets: what is read, and what is said of those that are none.
#include "drivers/canopen/data_sheet.hpp"

#include <fstream>
#include <string>

#include <doctest/doctest.h>

#include "tests/support/scratch_folder.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::canopen;

namespace {

const std::filesystem::path kShipped = checkout::source() / "firmware_app/config/can/cia402.eds";

std::string shipped() {
  std::ifstream stream(kShipped);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The shipped sheet with one place changed.
std::string changed(const std::string& from, const std::string& to) {
  std::string text = shipped();
  const std::size_t at = text.find(from);
  REQUIRE(at != std::string::npos);
  return text.replace(at, from.size(), to);
}

std::string refusal(const std::string& text) {
  try {
    const DataSheet sheet = parseDataSheet(text, "drive.eds", 3);
    requireTorqueDrive(sheet);
    parametersOf(sheet);
  } catch (const DataSheetError& error) {
    return error.what();
  }
  return "";
}

const std::string kMaxTorque = "[6072]\nParameterName=Max torque\nObjectType=0x7\nDataType=0x0006\n";

std::string withParameter(const std::string& value) {
  return changed(kMaxTorque, kMaxTorque + "ParameterValue=" + value + "\n");
}

}  // namespace

TEST_CASE("the shipped sheet is that of a torque drive") {
  const DataSheet sheet = loadDataSheet(kShipped, 2);
  CHECK_NOTHROW(requireTorqueDrive(sheet));
  CHECK(sheet.vendor == 0xCAFE);
  CHECK(sheet.product == 0x402);
  CHECK(parametersOf(sheet).empty());
  CHECK(sheet.entries.at({0x6071, 0}).mappable);
  CHECK(sheet.entries.at({0x6071, 0}).writable);
  CHECK_FALSE(sheet.entries.at({0x6041, 0}).writable);
  CHECK(sheet.entries.at({0x1018, 2}).data_type == 7);
}

TEST_CASE("names in any case, line ends of either kind, comments of either kind") {
  std::string text = changed("[6071]", "[6071]");
  for (std::size_t at = text.find("DataType"); at != std::string::npos; at = text.find("DataType", at + 1))
    text.replace(at, 8, "DATATYPE");
  for (std::size_t at = text.find("[1018sub"); at != std::string::npos; at = text.find("[1018sub", at + 1))
    text.replace(at, 8, "[1018Sub");
  std::string with_returns;
  for (const char c : text)
    with_returns += c == '\n' ? "\r\n" : std::string(1, c);
  CHECK(refusal(with_returns).empty());
  CHECK(refusal("; a comment\n# another\n" + text).empty());
}

TEST_CASE("parameters of a DCF are those that the set-up does not write itself") {
  const auto values = [](const std::string& text) {
    return parametersOf(parseDataSheet(text, "drive.dcf", 3));
  };
  const std::vector<ObjectValue> hex = values(withParameter("0x5DC"));
  REQUIRE(hex.size() == 1);
  CHECK(hex[0].index == 0x6072);
  CHECK(hex[0].sub == 0);
  CHECK(hex[0].bytes == 2);
  CHECK(hex[0].value == 1500);
  CHECK(values(withParameter("1500"))[0].value == 1500);
  CHECK(values(withParameter("02734"))[0].value == 1500);  // octal, as CiA 306 has it
  CHECK(values(withParameter("$NODEID+0x100"))[0].value == 0x103);
  CHECK(values(withParameter("0x100 + $NodeID"))[0].value == 0x103);
  CHECK(values(withParameter("-1"))[0].value == 0xFFFFFFFF);
  CHECK(values(withParameter("")).empty());
  // Communication, and what the loop commands.
  CHECK(values(changed("[1017]\nParameterName=", "[1017]\nParameterValue=100\nParameterName=")).empty());
  CHECK(values(changed("[6060]\nParameterName=", "[6060]\nParameterValue=3\nParameterName=")).empty());
  // An entry that cannot be written.
  CHECK(values(changed("[6076]\nParameterName=", "[6076]\nParameterValue=3\nParameterName=")).empty());
}

TEST_CASE("bad sheets are told of by file, section, key, value and what was expected") {
  CHECK(refusal("") == "drive.eds: holds no object, expected sections such as [1000] and [6041]");
  CHECK(refusal("[1000]\nDataType\n").starts_with("drive.eds:2: '=' character not found in line"));
  CHECK(refusal("[1000]\nDataType=7\nDataType=7\n").starts_with("drive.eds:3: duplicate key name"));
  CHECK(refusal("[1000]\nA=7\n[1000]\nA=7\n").starts_with("drive.eds:3: duplicate section name"));
  CHECK(refusal(changed("[6071]", "[2071]")) ==
        "drive.eds: has no object 6071h, target torque, expected that of a drive with cyclic synchronous "
        "torque");
  CHECK(refusal(changed("DataType=0x0003", "DataType=0x0004")) ==
        "drive.eds: [6071] DataType: value 0004h, expected 0003h for target torque");
  CHECK(refusal(changed("DataType=0x0003", "DataType=three")) ==
        "drive.eds: [6071] DataType: value 'three', expected a number such as 16, 0x10 or $NODEID+0x180");
  CHECK(refusal(changed("DataType=0x0003", "DataType=0x123456")) ==
        "drive.eds: [6071] DataType: value '0x123456', expected 0x0001 to 0xFFFF");
  CHECK(refusal(changed("AccessType=rww\nDefaultValue=0\nPDOMapping=1", "AccessType=rww\nPDOMapping=0")) ==
        "drive.eds: [6040] PDOMapping: value 0, expected 1: controlword has to be in a PDO");
  CHECK(refusal(changed("AccessType=rww", "AccessType=often")) ==
        "drive.eds: [6040] AccessType: value 'often', expected ro, wo, rw, rwr, rww or const");
  CHECK(refusal(withParameter("70000")) ==
        "drive.eds: [6072] ParameterValue: value 70000, expected one of 16 bits");
  CHECK(refusal(withParameter("1+2")).find("expected a number such as 16") != std::string::npos);
  CHECK(refusal(withParameter("0x")).find("expected a number such as 16") != std::string::npos);
  CHECK(refusal(shipped() + "\n[2000]\nDataType=0x0009\nAccessType=rw\nParameterValue=knee\n") ==
        "drive.eds: [2000] ParameterValue: of DataType 0009h, expected an integer of at most 4 bytes, or no "
        "value");
}

TEST_CASE("a sheet that is none, or too long, is refused before it is read") {
  const test::ScratchFolder folder;
  CHECK_THROWS_AS(loadDataSheet(folder.path() / "none.eds", 1), DataSheetError);
  CHECK_THROWS_AS(loadDataSheet(folder.path(), 1), DataSheetError);
  { std::ofstream(folder.path() / "long.eds") << std::string(4'000'001, ';'); }
  CHECK_THROWS_WITH_AS(loadDataSheet(folder.path() / "long.eds", 1), doctest::Contains("long.eds"),
                       DataSheetError);
}
