#include "drivers/can/sequence_counter.hpp"

#include <cstdint>
#include <initializer_list>

#include <doctest/doctest.h>

using namespace patella::can;

TEST_CASE("a counter tells new, repeated and missing frames apart, across its wrap") {
  for (const int bits : {4, 8}) {
    SequenceCounter counter(bits);
    const auto last = static_cast<std::uint64_t>(counter.modulus() - 1);
    CHECK(counter.modulus() == 1 << bits);
    CHECK(counter.check(last - 1).sequence == Sequence::kFirst);
    CHECK(counter.check(last).sequence == Sequence::kNew);
    CHECK(counter.check(0).sequence == Sequence::kNew);
    const SequenceStep repeated = counter.check(0);
    CHECK(repeated.sequence == Sequence::kRepeated);
    CHECK(repeated.steps == 0);
    const SequenceStep jumped = counter.check(5);
    CHECK(jumped.sequence == Sequence::kJumped);
    CHECK(jumped.steps == 5);
    CHECK(counter.check(4).steps == counter.modulus() - 1);
    // Further on than it may be: not followed.
    CHECK(counter.check(4 + 3, 2).sequence == Sequence::kImpossible);
    CHECK(counter.check(4 + 2, 2).steps == 2);
    CHECK(counter.check(4 + 2, 2).sequence == Sequence::kRepeated);
    counter.reset();
    CHECK(counter.check(4).sequence == Sequence::kFirst);
  }
}
