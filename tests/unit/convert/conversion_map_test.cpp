#include "tools/convert/conversion_map.hpp"

#include <doctest/doctest.h>

#include "firmware_app/files/file_error.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/convert/rig.hpp"

using namespace patella;
using namespace patella::convert;
using patella::test::messageOf;

namespace {

std::string errorOf(const std::string& frames) {
  const can::Database bus = test::rigBus();
  return messageOf<app::FileError>(
      [&] { parseMap("[recording]\ntime_column = \"t_s\"\n" + frames, "map.toml", bus); });
}

}  // namespace

TEST_CASE("the shipped maps fit the shipped bus") {
  const can::Database bus = test::rigBus();
  const ConversionMap emg = loadMap(test::shippedMap("leg_emg"), bus);
  CHECK(emg.rate_Hz == 1000.0);
  REQUIRE(emg.messages.size() == 1);
  CHECK(emg.messages[0].signals.size() == 4);
  CHECK(emg.columns().size() == 5);
  CHECK(loadMap(test::shippedMap("leg_emg_knee"), bus).messages.size() == 3);
  const ConversionMap pendulum = loadMap(test::shippedMap("double_pendulum"), bus);
  CHECK(pendulum.rate_Hz == 500.0);
  REQUIRE(pendulum.messages.size() == 3);
  CHECK(pendulum.messages[0].signals[0].offset == doctest::Approx(-M_PI / 2));
  CHECK(pendulum.messages[0].signals[0].interpolation == Interpolation::kCubic);
}

TEST_CASE("malformed maps are refused with file, line, key, value and expectation") {
  CHECK(errorOf("") == "map.toml:1: key 'frame': is missing, expected at least one [[frame]] table");
  CHECK(errorOf("[[frame]]\nmessage = \"Encoder\"")
            .starts_with("map.toml:4: key 'frame[1].message': value 'Encoder', expected a message of "));
  CHECK(errorOf("[[frame]]\nmessage = \"Encoder\"").ends_with("did you mean 'Encoder1'?"));
  CHECK(errorOf("[[frame]]\nmessage = \"Emg\"") ==
        "map.toml:4: key 'frame[1].message': 'Emg' has no [[frame.signal]], expected at least one");
  const std::string emg = "[[frame]]\nmessage = \"Emg\"\n[[frame.signal]]\n";
  CHECK(errorOf(emg + "signal = \"Channel9\"\ncolumn = \"a\"") ==
        "map.toml:6: key 'frame[1].signal[1].signal': value 'Channel9', expected one of 'Channel1', "
        "'Channel2', "
        "'Channel3', 'Channel4', 'Counter', 'Crc'");
  CHECK(errorOf(emg + "signal = \"Channel1\"") ==
        "map.toml:6: key 'frame[1].signal[1].signal': 'Channel1' needs exactly one of 'constant', 'column', "
        "'columns'");
  CHECK(errorOf(emg + "signal = \"Channel1\"\ncolumn = \"a\"\nconstant = 1") ==
        "map.toml:6: key 'frame[1].signal[1].signal': 'Channel1' needs exactly one of 'constant', 'column', "
        "'columns'");
  CHECK(errorOf(emg + "signal = \"Channel1\"\ncolumns = [\"a\", \"b\"]\nscales = [1]") ==
        "map.toml:8: key 'frame[1].signal[1].scales': 1 elements, expected an array of 2 finite numbers");
  CHECK(
      errorOf(emg + "signal = \"Channel1\"\ncolumn = \"a\"\ninterpolation = \"spline\"") ==
      "map.toml:8: key 'frame[1].signal[1].interpolation': value 'spline', expected one of 'hold', 'linear', "
      "'cubic'");
  CHECK(errorOf(emg + "signal = \"Channel1\"\ncolumn = \"a\"\nofset = 1") ==
        "map.toml:8: key 'frame[1].signal[1].ofset' is unknown, did you mean 'offset'?");
  CHECK(errorOf(emg +
                "signal = \"Channel1\"\ncolumn = \"a\"\n[[frame.signal]]\nsignal = \"Channel1\"\ncolumn = "
                "\"b\"") == "map.toml:9: key 'frame[1].signal[2].signal': 'Channel1' already has a source");
}
