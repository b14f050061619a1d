#include "drivers/gpio/gpiod_pins.hpp"

#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "firmware_app/realtime/allocation_counter.hpp"
#include "tests/unit/gpio/fake_gpiod.hpp"

namespace {

using patella::app::CountAllocations;
using patella::gpio::Bias;
using patella::gpio::GpiodPins;
using patella::gpio::GpiodPinsOptions;
using patella::test::chip;

constexpr unsigned kStop = 3;
constexpr unsigned kEnable = 4;
constexpr unsigned kHeartbeat = 5;

GpiodPinsOptions wired() {
  GpiodPinsOptions options;
  options.emergency_stop_line = kStop;
  options.drive_enable_line = kEnable;
  options.heartbeat_line = kHeartbeat;
  return options;
}

/// A healthy rig: the normally closed contact holds the stop line high.
void healthyChip() {
  patella::test::resetChip();
  chip().drive(kStop, true);
}

template <typename Exception>
std::string messageOf(const GpiodPinsOptions& options) {
  try {
    const GpiodPins pins(options);
  } catch (const Exception& error) {
    return error.what();
  }
  return "nothing was thrown";
}

}  // namespace

TEST_CASE("the emergency stop follows an active-low line") {
  healthyChip();
  GpiodPins pins(wired());
  CHECK(chip().lines[kStop].active_low);
  CHECK(chip().lines[kStop].both_edges);
  CHECK(chip().lines[kStop].pull_down);
  CHECK_FALSE(chip().lines[kStop].pull_up);
  CHECK_FALSE(pins.emergencyStop());

  chip().drive(kStop, false);
  CHECK(pins.emergencyStop());
  CHECK(pins.emergencyStop());  // held: the level alone says so

  chip().drive(kStop, true);
  CHECK(pins.emergencyStop());  // was still down on one side of the edge
  CHECK_FALSE(pins.emergencyStop());
}

TEST_CASE("a press between two ticks is seen once") {
  healthyChip();
  GpiodPins pins(wired());
  chip().drive(kStop, false);
  chip().drive(kStop, true);
  CHECK(pins.emergencyStop());
  CHECK_FALSE(pins.emergencyStop());
}

TEST_CASE("a bouncing contact keeps stopping until its edges are drained") {
  healthyChip();
  GpiodPins pins(wired());
  for (int bounce = 0; bounce < 20; ++bounce) {  // 40 edges, more than one read takes
    chip().drive(kStop, false);
    chip().drive(kStop, true);
  }
  int stops = 0;
  while (pins.emergencyStop() && stops < 100) {
    ++stops;
  }
  CHECK(stops >= 1);
  CHECK(stops <= 3);
  CHECK_FALSE(pins.emergencyStop());
}

TEST_CASE("a line that cannot be read stops") {
  healthyChip();
  GpiodPins pins(wired());
  chip().lines[kStop].broken = true;
  CHECK(pins.emergencyStop());
  chip().lines[kStop].broken = false;
  CHECK_FALSE(pins.emergencyStop());
}

TEST_CASE("outputs start low, take levels and go low in the end, drive first") {
  healthyChip();
  chip().drive(kEnable, true);  // as the boot loader may have left it
  {
    GpiodPins pins(wired());
    CHECK_FALSE(chip().lines[kEnable].physical);
    CHECK(pins.setDriveEnable(true));
    CHECK(chip().lines[kEnable].physical);
    pins.setHeartbeat(true);
    CHECK(chip().lines[kHeartbeat].physical);
    chip().writes.clear();
  }
  CHECK(chip().writes == "4=0 5=0 ");
  for (const unsigned line : {kStop, kEnable, kHeartbeat}) {
    CHECK_FALSE(chip().lines[line].requested);
  }
  CHECK(chip().open_chips == 0);
}

TEST_CASE("a refused output is reported") {
  healthyChip();
  GpiodPins pins(wired());
  chip().lines[kEnable].broken = true;
  CHECK_FALSE(pins.setDriveEnable(true));
  CHECK(pins.setHeartbeat(true));
  chip().lines[kHeartbeat].broken = true;
  CHECK_FALSE(pins.setHeartbeat(false));
}

TEST_CASE("what is not wired neither stops nor fails") {
  healthyChip();
  GpiodPinsOptions options;
  options.chip = "/dev/no_such_chip";
  GpiodPins pins(options);
  CHECK_FALSE(pins.emergencyStop());
  CHECK(pins.setDriveEnable(true));
  pins.setHeartbeat(true);
}

TEST_CASE("a chip may be given by its name alone, and active high pulled up") {
  healthyChip();
  chip().drive(kStop, false);
  GpiodPinsOptions options = wired();
  options.chip = "gpiochip0";
  options.emergency_stop_active_low = false;
  options.emergency_stop_bias = Bias::kPullUp;
  GpiodPins pins(options);
  CHECK(chip().lines[kStop].pull_up);
  CHECK_FALSE(pins.emergencyStop());
  chip().drive(kStop, true);
  CHECK(pins.emergencyStop());
}

TEST_CASE("set-up errors name the chip, the line and the reason") {
  healthyChip();
  GpiodPinsOptions options = wired();

  options.chip = "/dev/gpiochip9";
  std::string message = messageOf<std::runtime_error>(options);
  CHECK(message.find("/dev/gpiochip9") != std::string::npos);
  CHECK(message.find("line 4") != std::string::npos);
  CHECK(message.find("No such file or directory") != std::string::npos);

  options = wired();
  options.heartbeat_line = 42;
  message = messageOf<std::runtime_error>(options);
  CHECK(message.find("line 42") != std::string::npos);
  CHECK(message.find("Invalid argument") != std::string::npos);
  CHECK(chip().open_chips == 0);
  CHECK_FALSE(chip().lines[kEnable].requested);

  const GpiodPins first(wired());
  message = messageOf<std::runtime_error>(wired());
  CHECK(message.find("line 4") != std::string::npos);
  CHECK(message.find("busy") != std::string::npos);
}

TEST_CASE("wirings that hide a broken wire, and lines used twice, are refused") {
  healthyChip();
  GpiodPinsOptions options = wired();
  options.emergency_stop_bias = Bias::kPullUp;
  CHECK(messageOf<std::invalid_argument>(options).find("broken wire") != std::string::npos);
  options.emergency_stop_bias = Bias::kAsIs;
  CHECK_NOTHROW(GpiodPins{options});

  options.heartbeat_line = static_cast<int>(kEnable);
  CHECK(messageOf<std::invalid_argument>(options).find("line 4") != std::string::npos);
  options.heartbeat_line = -2;
  CHECK(messageOf<std::invalid_argument>(options).find("-2") != std::string::npos);
}

TEST_CASE("calls of the loop leave the heap alone") {
  healthyChip();
  GpiodPins pins(wired());
  chip().writes.reserve(1000);
  const CountAllocations count;
  chip().drive(kStop, false);
  for (int tick = 0; tick < 10; ++tick) {
    pins.emergencyStop();
    pins.setDriveEnable(tick % 2 == 0);
    pins.setHeartbeat(tick % 2 == 0);
  }
  CHECK(count.counts().allocations == 0);
  CHECK(count.counts().frees == 0);
}
