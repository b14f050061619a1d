#include <vector>

#include <doctest/doctest.h>

#include "firmware_app/realtime/allocation_counter.hpp"

TEST_CASE("without the interposed heap, the counter says that it does not count") {
  CHECK_FALSE(patella::app::CountAllocations::available());
  const patella::app::CountAllocations count;
  const std::vector<double> used(1000, 1.0);
  CHECK(used.back() == 1.0);
  CHECK(count.counts().allocations == 0);
}
