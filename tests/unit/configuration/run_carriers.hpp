// Run configurations that between them hold every key that core/bounds has a row for.
#pragma once

#include <vector>

#include "tests/unit/configuration/bound_carriers.hpp"

namespace patella::test {

std::vector<Carrier> runCarriers();

}  // namespace patella::test
