// Values of two joints, written in one expression.
#pragma once

#include "core/types.hpp"

namespace patella::test {

inline JointVector pair(double first, double second) {
  JointVector values(2);
  values << first, second;
  return values;
}

}  // namespace patella::test
