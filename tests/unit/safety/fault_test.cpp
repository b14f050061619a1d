#include "core/safety/fault.hpp"

#include <set>
#include <string>

#include <doctest/doctest.h>

using patella::safety::Fault;
using patella::safety::faultName;
using patella::safety::FaultSet;

TEST_CASE("every fault has a name of its own and the numbers of recorded logs stay") {
  std::set<std::string> names;
  for (int i = 0; i < patella::safety::kFaultCount; ++i) {
    names.emplace(faultName(static_cast<Fault>(i)));
  }
  CHECK(names.size() == static_cast<std::size_t>(patella::safety::kFaultCount));
  CHECK(names.count("unknown") == 0);
  CHECK(faultName(Fault::kCount) == "unknown");
  CHECK(static_cast<int>(Fault::kEmergencyStop) == 0);
  CHECK(static_cast<int>(Fault::kBusOff) == 8);
  CHECK(static_cast<int>(Fault::kTorqueLimit) == 14);
}

TEST_CASE("fault sets combine, intersect and tell their first") {
  const FaultSet both{Fault::kBusOff, Fault::kOverrun};
  CHECK(both.has(Fault::kBusOff));
  CHECK_FALSE(both.has(Fault::kEmergencyStop));
  CHECK(both.first() == Fault::kBusOff);
  CHECK(FaultSet{}.first() == Fault::kCount);
  CHECK((both & FaultSet{Fault::kOverrun}) == FaultSet{Fault::kOverrun});
  CHECK(both.without(FaultSet{Fault::kBusOff}) == FaultSet{Fault::kOverrun});
  CHECK((FaultSet{Fault::kBusOff} | FaultSet{Fault::kOverrun}) == both);
  CHECK(FaultSet(both.bits()) == both);
}
