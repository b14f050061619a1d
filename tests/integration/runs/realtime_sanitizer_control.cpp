// A loop over a bus that allocates. Under RealtimeSanitizer this must not get through its first tick.
#include <cstdio>

#include "tests/integration/runs/demonstration.hpp"

int main() {
  patella::test::runInLockStep(patella::test::demonstration(0.1), true);
  std::puts("an allocation in the tick went unnoticed");
  return 1;
}
