#include <doctest/doctest.h>

#include "firmware_app/recorder/loop_statistics.hpp"

using patella::JointVector;
using patella::app::ErrorStatistics;

TEST_CASE("errors are summed by joint: absolute, squared, largest") {
  ErrorStatistics errors;
  const JointVector truth = JointVector::Zero(2);
  JointVector estimate(2);
  estimate << 3.0, -1.0;
  errors.add(estimate, truth);
  estimate << -1.0, 2.0;
  errors.add(estimate, truth);
  CHECK(errors.count == 2);
  CHECK(errors.sum[0] == 4.0);
  CHECK(errors.sum[1] == 3.0);
  CHECK(errors.sum_of_squares[0] == 10.0);
  CHECK(errors.sum_of_squares[1] == 5.0);
  CHECK(errors.maximum[0] == 3.0);
  CHECK(errors.maximum[1] == 2.0);
}

TEST_CASE("one joint leaves the other's sums at zero") {
  ErrorStatistics errors;
  errors.add(JointVector::Constant(1, 2.0), JointVector::Constant(1, 5.0));
  CHECK(errors.sum[0] == 3.0);
  CHECK(errors.sum[1] == 0.0);
}
