#include "firmware_app/files/wording.hpp"

#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include <doctest/doctest.h>

using namespace patella::app;

TEST_CASE("numbers read back as the same double") {
  for (const double value : {0.1, 1.0 / 3.0, 20000.0, 1e-6, -9.80665, std::numeric_limits<double>::max(),
                             std::numeric_limits<double>::denorm_min()}) {
    CHECK(std::strtod(formatNumber(value).c_str(), nullptr) == value);
  }
  CHECK(formatNumber(20000.0) == "20000");
  CHECK(formatNumber(0.1) == "0.1");
}

TEST_CASE("a suggestion prefers wrong case to wrong letters and is silent when nothing is near") {
  const std::vector<std::string> names{"rate_Hz", "rates_hz", "gravity_m_s2"};
  CHECK(nearestName("rate_hz", names) == "rate_Hz");
  CHECK(nearestName("gravty_m_s2", names) == "gravity_m_s2");
  CHECK(nearestName("gravity", names) == "gravity_m_s2");
  CHECK(nearestName("delay_s", names).empty());
  CHECK(suggestion("rate_hz", names) == ", did you mean 'rate_Hz'?");
  CHECK(suggestion("completely_different", names).empty());
}
