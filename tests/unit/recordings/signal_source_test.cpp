// Signals that are made of columns: scaled, in units, of currents, of several columns.
#include <numbers>

#include <doctest/doctest.h>

#include "tests/unit/recordings/mapped.hpp"

using namespace patella;
using namespace patella::diagnose;
using patella::test::csv;

namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

/// Columns t, q, a, b; q counts up by 0.01, a is 2, b is 0.5 throughout.
std::string table() {
  return csv("t,q,a,b", 200, [](int i) { return fmt::format("{},{},2,0.5", 0.001 * i, 0.01 * i); });
}

std::string mapOf(const std::string& position, const std::string& torque) {
  return "[recording]\ntime_column = \"t\"\ntorque = \"held\"\n[[joint]]\nposition = " + position +
         "\ntorque = " + torque + "\n";
}

double torque(const std::string& source) {
  return test::mapped(mapOf("{ column = 'q' }", source), table()).torque_Nm[0][10];
}

double position(const std::string& source) {
  return test::mapped(mapOf(source, "{ column = 'a' }"), table()).position_rad[0][10];
}

std::string refusedTorque(const std::string& source) {
  return test::mappedRefusal(mapOf("{ column = 'q' }", source), table());
}

}  // namespace

TEST_CASE("a torque is a current times torque constant and gear") {
  CHECK(torque("{ column = 'a', torque_constant_Nm_A = 0.09, gear = 6 }") == doctest::Approx(1.08));
  CHECK(torque("{ column = 'a', torque_constant_Nm_A = 0.09 }") == doctest::Approx(0.18));
  // A current in mA, of a motor that turns the other way, and a torque that it takes to hold a cable.
  CHECK(torque("{ column = 'a', scale = 0.001, torque_constant_Nm_A = 90, gear = -6, offset = 0.25 }") ==
        doctest::Approx(-0.83));
}

TEST_CASE("what makes no torque of a current is refused") {
  CHECK(refusedTorque("{ column = 'a', gear = 6 }") ==
        "map.toml:6: key 'joint[1].torque.gear': stands without 'torque_constant_Nm_A', expected both for a "
        "current, or 'scale' for a torque");
  CHECK(refusedTorque("{ column = 'a', torque_constant_Nm_A = 0 }") ==
        "map.toml:6: key 'joint[1].torque.torque_constant_Nm_A': value 0, expected a number greater than 0");
  CHECK(refusedTorque("{ column = 'a', torque_constant_Nm_A = 1, gear = 0 }") ==
        "map.toml:6: key 'joint[1].torque.gear': value 0, expected a number other than 0");
  CHECK(refusedTorque("{ column = 'a', torque_constant_Nm_A = 1, unit = 'mN.m' }") ==
        "map.toml:6: key 'joint[1].torque.unit': stands beside 'torque_constant_Nm_A', which gives N·m of A; "
        "expected 'scale' for a current in another unit");
  CHECK(test::mappedRefusal(mapOf("{ column = 'q', gear = 6 }", "{ column = 'a' }"), table()) ==
        "map.toml:5: key 'joint[1].position.gear' is unknown");
}

TEST_CASE("a signal is the sum of columns, each with its scale") {
  CHECK(torque("{ sum = [ { column = 'a' }, { column = 'b', scale = -2 } ], offset = 0.1 }") ==
        doctest::Approx(1.1));
  CHECK(torque("{ sum = [ { column = 'a' }, { column = 'b' } ], unit = 'kN.m' }") == doctest::Approx(2500.0));
  CHECK(torque("{ sum = [ { column = 'a', torque_constant_Nm_A = 0.1, gear = 5 }, { column = 'b' } ] }") ==
        doctest::Approx(1.5));
  CHECK(position("{ sum = [ { column = 'q' }, { column = 'q', scale = 2 } ] }") == doctest::Approx(0.3));
}

TEST_CASE("a sum that is none is refused") {
  CHECK(refusedTorque("{ sum = [] }") ==
        "map.toml:6: key 'joint[1].torque.sum': 0 columns, expected at least one");
  CHECK(refusedTorque("{ sum = [ { column = 'a' } ], column = 'b' }") ==
        "map.toml:6: key 'joint[1].torque.sum': stands beside 'column', expected one of the two");
  CHECK(refusedTorque("{ sum = [ { column = 'a' } ], constant = 1 }") ==
        "map.toml:6: key 'joint[1].torque.constant': stands beside 'sum', expected one of the two");
  CHECK(refusedTorque("{ sum = [ { column = 'a' }, { column = 'c' } ] }") ==
        "run.csv:1: there is no column 'c', did you mean 'b'?; the file has 't', 'q', 'a', 'b'");
  CHECK(refusedTorque("{ sum = [ { column = 'a', scale = 0 } ] }") ==
        "map.toml:6: key 'joint[1].torque.sum[1].scale': value 0, expected a number other than 0");
  CHECK(refusedTorque("{ sum = [ { column = 'a' } ], scale = 2 }")
            .starts_with("map.toml:6: key 'joint[1].torque.scale' is unknown"));
}

TEST_CASE("units are converted, zero offsets and constants in the same unit") {
  CHECK(position("{ column = 'q', unit = 'rad' }") == doctest::Approx(0.1));
  CHECK(position("{ column = 'q', unit = 'deg' }") == doctest::Approx(0.1 * kDegree));
  CHECK(position("{ column = 'q', unit = 'deg', scale = -10, offset = 90 }") ==
        doctest::Approx(89.0 * kDegree));
  CHECK(position("{ column = 'q', unit = 'turn' }") == doctest::Approx(0.2 * std::numbers::pi));
  CHECK(position("{ column = 'q', unit = 'mm' }") == doctest::Approx(1e-4));
  CHECK(position("{ constant = 90, unit = 'deg' }") == doctest::Approx(90.0 * kDegree));
  CHECK(torque("{ column = 'a', unit = 'mN.m' }") == doctest::Approx(0.002));
  CHECK(torque("{ column = 'a', unit = 'N.mm', offset = 500 }") == doctest::Approx(0.502));
  CHECK(torque("{ column = 'a', unit = 'kN.m' }") == doctest::Approx(2000.0));
  CHECK(torque("{ column = 'a', unit = 'N' }") == 2.0);
  CHECK(torque("{ constant = 3, unit = 'mN.m' }") == doctest::Approx(0.003));
}

TEST_CASE("a unit that is not known names those that are") {
  CHECK(
      test::mappedRefusal(mapOf("{ column = 'q', unit = 'degree' }", "{ column = 'a' }"), table()) ==
      "map.toml:5: key 'joint[1].position.unit': value 'degree', expected one of 'rad', 'deg', 'turn', 'm', "
      "'mm'");
  CHECK(refusedTorque("{ column = 'a', unit = 'deg' }") ==
        "map.toml:6: key 'joint[1].torque.unit': value 'deg', expected one of 'N.m', 'mN.m', 'N.mm', 'N.cm', "
        "'kN.m', 'N', 'kN'");
}

TEST_CASE("stamps in other units of time") {
  for (const auto& [unit, step] : {std::pair{"s", 0.002}, {"ms", 2.0}, {"us", 2e3}, {"ns", 2e6}}) {
    CAPTURE(unit);
    const std::string map = fmt::format(
        "[recording]\ntime_column = 't'\ntime_unit = '{}'\ntorque = 'held'\n[[joint]]\nposition = {{ column "
        "= "
        "'q' }}\ntorque = {{ column = 'q' }}\n",
        unit);
    const double in_unit = step;
    CHECK(test::mapped(map, csv("t,q", 200, [=](int i) { return fmt::format("{},{}", in_unit * i, i); }))
              .rate_Hz == 500.0);
  }
  const std::string map = mapOf("{ column = 'q' }", "{ column = 'a' }");
  const auto with = [&](const std::string& line) { return "[recording]\n" + line + map.substr(12); };
  CHECK(test::mappedRefusal(with("time_unit = 'min'\n"), table()) ==
        "map.toml:2: key 'recording.time_unit': value 'min', expected one of 's', 'ms', 'us', 'ns'");
  CHECK(test::mappedRefusal(with("time_unit = 'ms'\ntime_scale_s = 0.001\n"), table()) ==
        "map.toml:2: key 'recording.time_unit': stands beside 'time_scale_s', expected one of the two");
}

TEST_CASE("EMG and activation have units, and no more channels than the loop") {
  const std::string joint = mapOf("{ column = 'q' }", "{ column = 'a' }");
  CHECK(test::mapped(joint + "[[activation]]\ncolumn = 'b'\nunit = 'percent'\n", table()).activation[0][7] ==
        doctest::Approx(0.005));
  CHECK(test::mapped(joint + "[[activation]]\nsum = [ { column = 'b', scale = 0.5 }, { column = 'b' } ]\n",
                     table())
            .activation[0][7] == doctest::Approx(0.75));
  std::string channels;
  for (int i = 0; i < 5; ++i) {
    channels += "[[activation]]\ncolumn = 'b'\n";
  }
  CHECK(
      test::mappedRefusal(joint + channels, table()) ==
      "map.toml:7: key 'activation': 5 channels, expected at most 4: choose the muscles that move the joints "
      "of the model, or add the activations of one group of muscles by 'sum'");
}
