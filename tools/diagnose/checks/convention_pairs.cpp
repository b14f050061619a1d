#include "tools/diagnose/checks/convention_pairs.hpp"

#include <algorithm>
#include <utility>

#include "tools/diagnose/checks/convention_search.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

using namespace convention;

/// First ones that are looked behind, beside signs: that many take a second or two.
constexpr std::size_t kMostFirst = 6;

/// Joints of which each may have conventions of its own.
constexpr int kMostSingly = 2;

bool isSign(const Convention& convention) {
  return convention.kind == ConventionKind::kTorqueSign || convention.kind == ConventionKind::kPositionSign;
}

bool isAlike(const Convention& a, const Convention& b) {
  return a.kind == b.kind && a.joint == b.joint && a.exchanged == b.exchanged;
}

// The first is put right before the second.
Convention both(const Convention& first, const Convention& second) {
  return {.kind = ConventionKind::kTwo,
          .mistake = first.mistake + " and " + second.mistake,
          .change = first.change + ", then " + second.change,
          .correct =
              [one = first.correct, other = second.correct](Series& series) {
                one(series);
                other(series);
              },
          .torque_only = first.torque_only && second.torque_only,
          .parts = {first, second}};
}

// Those of all joints together, where there are more than a few.
void keepWithin(std::vector<ReadAs>& alone, Extent extent) {
  if (extent == Extent::kAllTogether) {
    std::erase_if(alone, [](const ReadAs& one) {
      return one.convention.joint != kAllJoints || one.convention.exchanged[0] >= 0;
    });
  }
}

// The best of each kind on each joint, those that explain most before the others; every sign.
std::vector<ReadAs> firstOnes(std::vector<ReadAs> alone) {
  std::stable_sort(alone.begin(), alone.end(), [&](const ReadAs& a, const ReadAs& b) {
    return gain(a.reading.error, b.reading.error) < 0.0;
  });
  std::vector<ReadAs> first;
  std::size_t others = 0;
  for (ReadAs& one : alone) {
    const bool known = std::any_of(first.begin(), first.end(), [&](const ReadAs& other) {
      return isAlike(other.convention, one.convention);
    });
    if (isSign(one.convention) || (!known && others < kMostFirst)) {
      others += isSign(one.convention) ? 0 : 1;
      first.push_back(std::move(one));
    }
  }
  return first;
}

bool isFarOff(const Reading& given) {
  return std::any_of(given.error.begin(), given.error.end(), [](double error) { return error > kFarOff; });
}

// What such a convention gains by itself, at its best.
double gainAlone(const Convention& convention, const std::vector<ReadAs>& alone, const Reading& given) {
  double most = 0.0;
  for (const ReadAs& one : alone) {
    if (isAlike(one.convention, convention)) {
      most = std::max(most, gain(given.error, one.reading.error));
    }
  }
  return most;
}

}  // namespace

std::vector<ReadAs> believedPairs(const Reader& reader, const Reading& given, const ColumnNames& names,
                                  std::vector<ReadAs> alone) {
  if (reader.hasJointAtRest() || reader.hasJointThatHardlyBends() || !isFarOff(given)) {
    return {};
  }
  const Extent extent = names.joints > kMostSingly ? Extent::kAllTogether : Extent::kEach;
  keepWithin(alone, extent);
  std::vector<ReadAs> pairs;
  for (const ReadAs& first : firstOnes(alone)) {
    Reader behind = reader.putRight(first.convention);
    const double gained_by_first = gainAlone(first.convention, alone, given);
    for (const ReadAs& second : readings(behind, given, names, extent)) {
      if (isAlike(first.convention, second.convention)) {
        continue;
      }
      ReadAs pair{.convention = both(first.convention, second.convention), .reading = second.reading};
      // Plain effects that explain as much are the more likely story.
      const bool beyond_effects = gain(given.error_with_effects, pair.reading.error) >= 0.0;
      const double most_alone = std::max(gained_by_first, gainAlone(second.convention, alone, given));
      if (beyond_effects && gainOf(pair, given) > most_alone + leastGainOfPair() && isBelieved(pair, given)) {
        pairs.push_back(std::move(pair));
      }
    }
  }
  return pairs;
}

}  // namespace patella::diagnose
