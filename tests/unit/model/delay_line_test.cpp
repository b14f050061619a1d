// The recent past of a signal against all of its samples.
#include "core/model/effects/delay_line.hpp"

#include <algorithm>
#include <random>
#include <vector>

#include <doctest/doctest.h>

using namespace patella::model;

namespace {

struct Sample {
  double time_s;
  double value;
};

double between(const std::vector<Sample>& samples, double time_s) {
  const auto later = std::find_if(samples.begin(), samples.end(),
                                  [time_s](const Sample& sample) { return sample.time_s > time_s; });
  if (later == samples.begin()) {
    return samples.front().value;
  }
  if (later == samples.end()) {
    return samples.back().value;
  }
  const Sample& a = *(later - 1);
  return a.value + (later->value - a.value) * (time_s - a.time_s) / (later->time_s - a.time_s);
}

}  // namespace

TEST_CASE("a delayed signal lies between its samples, whether they follow each other evenly or not") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const double unevenness : {0.0, 0.3, 0.9}) {
    for (const double period_s : {2e-4, 1e-3, 5e-3}) {
      CAPTURE(unevenness);
      CAPTURE(period_s);
      DelayLine<100> line;
      line.reset(0.5);
      std::vector<Sample> samples{{0.0, 0.5}};
      for (int i = 0; i < 2000; ++i) {
        const double dt_s = period_s * (1.0 + unevenness * (share(random) - 0.5));
        samples.push_back({samples.back().time_s + dt_s, share(random)});
        line.push(samples.back().value, dt_s);
        for (const double delay_s : {0.4 * period_s, period_s, 3.0 * period_s, 0.1 * share(random)}) {
          const double expected = between(samples, samples.back().time_s - delay_s);
          REQUIRE(line.at(delay_s, 0.0, samples.back().value) == doctest::Approx(expected).epsilon(1e-6));
        }
      }
    }
  }
}
