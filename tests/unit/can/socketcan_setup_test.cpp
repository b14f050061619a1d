#include <stdexcept>
#include <string>

#include <doctest/doctest.h>

#include "drivers/can/error_monitor.hpp"
#include "drivers/can/socketcan_bus.hpp"

using namespace patella::can;

TEST_CASE("an interface that cannot be used is named with the reason") {
  for (const char* interface : {"nocan0", "a-name-too-long-for-linux"}) {
    std::string why;
    try {
      SocketCanBus bus(interface);
    } catch (const std::runtime_error& error) {
      why = error.what();
    }
    CAPTURE(why);
    CHECK(why.starts_with(std::string("CAN interface '") + interface + "': "));
    const bool named = why.find("no such interface") != std::string::npos ||
                       why.find("this kernel has no CAN support") != std::string::npos ||
                       why.find("not permitted") != std::string::npos;
    CHECK(named);
  }
}

TEST_CASE("bus-off lasts until a restart or a frame from another node") {
  ErrorMonitor monitor;
  BusStatistics statistics;
  Frame report;
  report.error = true;
  report.id = kErrorBusOff;
  monitor.observe(report, statistics);
  CHECK(monitor.busOff());
  Frame data;
  data.own = true;
  monitor.observe(data, statistics);
  CHECK(monitor.busOff());
  data.own = false;
  monitor.observe(data, statistics);
  CHECK_FALSE(monitor.busOff());
  monitor.observe(report, statistics);
  report.id = kErrorRestarted;
  monitor.observe(report, statistics);
  CHECK_FALSE(monitor.busOff());
  CHECK(statistics.bus_off == 2);
  CHECK(statistics.error_frames == 3);
}

TEST_CASE("a bus-off that is over within the same tick is still told") {
  ErrorMonitor monitor;
  BusStatistics statistics;
  Frame report;
  report.error = true;
  report.id = kErrorBusOff;
  monitor.beginReceive();
  monitor.observe(report, statistics);
  monitor.observe(Frame{}, statistics);
  CHECK_FALSE(monitor.busOff());
  CHECK(monitor.wasOff());
  monitor.beginReceive();
  CHECK_FALSE(monitor.wasOff());
}
