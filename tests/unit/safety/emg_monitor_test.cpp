// When an electrode is off, saturated or drowned by the mains, and what muscle may do.
#include "core/safety/emg_monitor.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include <doctest/doctest.h>

#include "core/bounds/bounds.hpp"
#include "tests/unit/safety/safety_fixture.hpp"

using namespace patella;
using namespace patella::safety;
using namespace patella::test;

namespace {

constexpr std::array<bool, kMaxEmgChannels> kSecond = {false, true, false, false};

// Ticks until `fault` with signal(k) on the second electrode; at most 5000.
template <typename Signal>
int emgUntil(Fault fault, Signal&& signal, const std::array<bool, kMaxEmgChannels>& used = kSecond) {
  EmgMonitor monitor({}, used, 1000.0, 50.0);
  for (int k = 0; k < 5000; ++k) {
    if (monitor.update({0.0, signal(k), 0.0, 0.0}, 1).has(fault)) {
      return k;
    }
  }
  return -1;
}

// Noise of 0.2 mV rms or so, the same everywhere.
double muscle(int k) {
  return 0.28 * std::sin(12.9898 * k * k + 78.233 * k);
}

}  // namespace

TEST_CASE("muscle, and moderate hum, are in order") {
  const auto signal = [](int k) { return muscle(k) + 0.1 * std::sin(0.1 * std::numbers::pi * k); };
  for (const Fault fault : {Fault::kEmgElectrodeOff, Fault::kEmgSaturated, Fault::kEmgHum}) {
    CHECK(emgUntil(fault, signal) == -1);
  }
}

TEST_CASE("an electrode that stands still is off, and only one that is used") {
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int k) { return k < 1000 ? muscle(k) : 0.3; }) == 1501);
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int) { return 0.0; }) == 500);
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int k) { return k % 2 == 0 ? 0.0 : 0.00075; }) == 500);
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int k) { return k % 2 == 0 ? 0.0 : 0.0015; }) == -1);
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int) { return 0.0; }, {true, false, true, true}) == 500);
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int) { return 0.0; }, {}) == -1);
}

TEST_CASE("without a band no electrode stands still, and the other faults are judged all the same") {
  EmgMonitorSettings settings;
  settings.flat_mV = 0.0;
  EmgMonitor monitor(settings, kSecond, 1000.0, 50.0);
  FaultSet faults;
  for (int k = 0; k < 5000; ++k)
    faults = faults | monitor.update({0.0, 0.3, 0.0, 0.0}, 1);
  CHECK_FALSE(faults.any());
  for (int k = 0; k < 50; ++k)
    faults = faults | monitor.update({0.0, 1.5, 0.0, 0.0}, 1);
  CHECK(faults == FaultSet{Fault::kEmgSaturated});
}

TEST_CASE("the shortest time of standing still is the one that is configured") {
  EmgMonitorSettings settings;
  settings.flat_time_s = boundOf("safety.emg.flat_time_s").minimum;
  EmgMonitor monitor(settings, kSecond, 1000.0, 50.0);
  int found = 0;
  while (found < 1000 && !monitor.update({0.0, 0.3, 0.0, 0.0}, 1).any())
    ++found;
  CHECK(found * kTick_s == doctest::Approx(settings.flat_time_s).epsilon(0.1));
}

TEST_CASE("an electrode at the end of its range is saturated") {
  CHECK(emgUntil(Fault::kEmgSaturated, [](int k) { return k < 100 ? muscle(k) : 1.5; }) == 120);
  CHECK(emgUntil(Fault::kEmgSaturated, [](int k) { return k < 100 ? muscle(k) : -1.5; }) == 120);
  CHECK(emgUntil(Fault::kEmgSaturated, [](int k) { return k % 20 == 0 ? 1.5 : muscle(k); }) == -1);
  CHECK(emgUntil(Fault::kEmgSaturated, [](int) { return 1.44; }) == -1);
  // It stands still there, too, and is told from one that is off.
  CHECK(emgUntil(Fault::kEmgElectrodeOff, [](int) { return 1.5; }) == -1);
}

TEST_CASE("mains hum is told from muscle by its frequency") {
  const auto hum = [](double amplitude_mV, double frequency_Hz) {
    return emgUntil(Fault::kEmgHum, [=](int k) {
      const double t = k * kTick_s;
      return muscle(k) +
             (k < 1000 ? 0.0 : amplitude_mV * std::sin(2.0 * std::numbers::pi * frequency_Hz * t));
    });
  };
  const int at_mains = hum(1.0, 50.0);
  CHECK(at_mains > 1200);
  CHECK(at_mains < 1300);
  CHECK(hum(0.25, 50.0) == -1);
  CHECK(hum(1.0, 80.0) == -1);
}

TEST_CASE("of mains that are not known, 50 and 60 Hz are hum, and muscle is neither") {
  const auto hums = [](double mains_Hz, double hum_Hz, double amplitude_mV) {
    EmgMonitor monitor({}, kSecond, 1000.0, mains_Hz);
    bool found = false;
    for (int k = 0; k < 3000 && !found; ++k) {
      const double hum_mV = amplitude_mV * std::sin(2.0 * std::numbers::pi * hum_Hz * k * kTick_s);
      found = monitor.update({0.0, muscle(k) + hum_mV, 0.0, 0.0}, 1).has(Fault::kEmgHum);
    }
    return found;
  };
  CHECK(hums(0.0, 50.0, 0.6));
  CHECK(hums(0.0, 60.0, 0.6));
  CHECK_FALSE(hums(50.0, 60.0, 0.6));
  CHECK_FALSE(hums(60.0, 50.0, 0.6));
  CHECK_FALSE(hums(0.0, 50.0, 0.2));
  CHECK_FALSE(hums(0.0, 60.0, 0.2));
  CHECK_FALSE(hums(0.0, 80.0, 0.6));
}

TEST_CASE("what an electrode says after a gap is no more than one sample") {
  // Muscle at its loudest, and a gap of nearly the timeout again and again: nothing but muscle.
  EmgMonitor monitor({}, kSecond, 1000.0, 50.0);
  FaultSet faults;
  for (int k = 0; k < 20000; ++k) {
    const bool after_gap = k % 300 == 299;
    faults = faults | monitor.update({0.0, after_gap ? 1.5 : muscle(k), 0.0, 0.0}, after_gap ? 49 : 1);
  }
  CHECK_FALSE(faults.any());
}

TEST_CASE("lost frames hide neither hum nor an electrode that is off or saturated") {
  const auto foundAfter = [](Fault fault, auto&& signal) {
    EmgMonitor monitor({}, kSecond, 1000.0, 50.0);
    std::mt19937 random(7);
    int steps = 0;
    for (int k = 0; k < 2000; ++k) {
      ++steps;
      if (random() % 4 != 0) {  // three in four are lost
        continue;
      }
      if (monitor.update({0.0, signal(k * kTick_s), 0.0, 0.0}, steps).has(fault)) {
        return k;
      }
      steps = 0;
    }
    return -1;
  };
  const auto within = [](int found, int longest) { return found > 0 && found <= longest; };
  CHECK(within(
      foundAfter(Fault::kEmgHum, [](double t) { return std::sin(2.0 * std::numbers::pi * 50.0 * t); }), 600));
  CHECK(within(foundAfter(Fault::kEmgElectrodeOff, [](double) { return 0.1; }), 700));
  CHECK(within(foundAfter(Fault::kEmgSaturated, [](double) { return 1.5; }), 60));
}

TEST_CASE(
    "an electrode without a number is a fault for as long as it is so, and one that nobody uses is none") {
  EmgMonitor monitor({}, kSecond, 1000.0, 50.0);
  CHECK_FALSE(monitor.update({kNaN, 0.1, kNaN, kNaN}, 1).any());
  CHECK(monitor.update({0.0, kNaN, 0.0, 0.0}, 1) == FaultSet{Fault::kNotFinite});
  CHECK_FALSE(monitor.update({0.0, 0.2, 0.0, 0.0}, 1).any());
}
