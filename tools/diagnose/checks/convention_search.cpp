#include "tools/diagnose/checks/convention_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/checks/convention_pairs.hpp"
#include "tools/diagnose/checks/mounting.hpp"
#include "tools/diagnose/fit/sticking.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

using namespace convention;

/// Nobody reads more.
constexpr std::size_t kMostTold = 6;

/// A number on a grid, then between its best neighbours.
struct Grid {
  double first = 0.0, last = 0.0, step = 0.0, resolution = 0.0;
  bool turns = false;  ///< the last number is next to the first
};

// Nothing where the best is at an end of the grid: what would explain most lies beyond what the convention
// means.
std::optional<ReadAs> bestOn(const Grid& grid, Reader& reader, const Reading& given,
                             const std::function<Convention(double, const Range&)>& convention) {
  std::vector<ReadAs> tried;
  std::vector<double> gains, numbers;
  const auto consider = [&](double number) {
    ReadAs one{.convention = convention(number, {number, number}), .reading = {}};
    one.reading = reader.read(one.convention);
    gains.push_back(gainOf(one, given));
    numbers.push_back(number);
    tried.push_back(std::move(one));
  };
  const auto best = [&] {
    return static_cast<std::size_t>(std::max_element(gains.begin(), gains.end()) - gains.begin());
  };
  for (double number = grid.first; number <= grid.last; number += grid.step) {
    consider(number);
  }
  for (double step = 0.5 * grid.step; step > grid.resolution; step *= 0.5) {
    const double centre = numbers[best()];
    consider(std::max(centre - step, grid.first));
    consider(std::min(centre + step, grid.last));
  }
  if (!grid.turns &&
      (numbers[best()] < grid.first + grid.resolution || numbers[best()] > grid.last - grid.resolution)) {
    return std::nullopt;
  }
  const double found = numbers[best()];
  const ReadAs& most = tried[best()];
  Range range{found, found};
  for (std::size_t i = 0; i < tried.size(); ++i) {
    if (asGood(tried[i], most)) {
      range = {std::min(range[0], numbers[i]), std::max(range[1], numbers[i])};
    }
  }
  return ReadAs{.convention = convention(found, range), .reading = most.reading};
}

std::vector<int> eachAndAll(int joints) {
  std::vector<int> chosen;
  for (int joint = joints > 1 ? kAllJoints : 0; joint < joints; ++joint) {
    chosen.push_back(joint);
  }
  return chosen;
}

// The best, and what is as good, the better before the others.
void keepBest(std::vector<ReadAs>& all, const Reading& given) {
  std::sort(all.begin(), all.end(),
            [&](const ReadAs& a, const ReadAs& b) { return gainOf(a, given) > gainOf(b, given); });
  if (!all.empty()) {
    const ReadAs best = all.front();
    std::erase_if(all, [&](const ReadAs& one) { return !asGood(one, best); });
  }
}

std::vector<Convention> conventionsOf(const std::vector<ReadAs>& all) {
  std::vector<Convention> conventions;
  for (const ReadAs& one : all) {
    conventions.push_back(one.convention);
  }
  return conventions;
}

// Units in which the model explains angles better than as given, and that make them smaller: the best, and
// what is as good, with another wrong convention where that is believed; `counts`: those of encoders, too.
std::vector<Convention> smallerAngles(Reader& reader, const ColumnNames& names, bool counts) {
  const Reading given = reader.asGiven();
  std::vector<Convention> units;
  if (counts) {
    units = encoderCounts(names);
  }
  for (Convention& known : knownConventions(names)) {
    units.push_back(std::move(known));
  }
  std::vector<ReadAs> better;
  for (const Convention& convention : units) {
    if (convention.kind == ConventionKind::kPositionUnit && convention.number > 1.0) {
      better.push_back({.convention = convention, .reading = reader.read(convention)});
    }
  }
  if (std::none_of(better.begin(), better.end(),
                   [](const ReadAs& one) { return leavesAsMachines(one.reading); })) {
    std::vector<ReadAs> pairs = believedPairs(reader, given, names, better);
    keepBest(pairs, given);
    if (!pairs.empty()) {
      return conventionsOf(pairs);
    }
  }
  keepBest(better, given);
  std::erase_if(better, [&](const ReadAs& one) { return gainOf(one, given) <= 0.0; });
  return conventionsOf(better);
}

// " looks like q2_rad is in degrees (q2·π/180), or …"; empty where there is none.
std::string told(std::span<const Convention> conventions) {
  std::string look;
  std::size_t count = 0;
  for (const Convention& one : conventions) {
    const std::string name = fmt::format("{} ({})", one.mistake, one.change);
    if (count < kMostTold && look.find(name) == std::string::npos) {
      look += (count++ == 0 ? " looks like " : ", or ") + name;
    }
  }
  return look;
}

// A base at another angle turns gravity, as zeros and units of angles may, and where it explains as much it
// is named beside them. By little it is a cause that a diagnosis takes out.
void addMounting(const Dataset& data, const model::ModelDescription& model, const Reading& given,
                 std::vector<ReadAs>& wrong) {
  if (wrong.empty() &&
      std::none_of(given.error.begin(), given.error.end(), [](double error) { return error > kFarOff; })) {
    return;
  }
  const std::optional<ReadAs> mounting = bestMounting(data, model, given);
  const bool little = mounting && wrong.empty() && mounting->convention.number < kLeastZero_rad;
  if (mounting && !little && isBelieved(*mounting, given)) {
    wrong.push_back(*mounting);
    keepBest(wrong, given);
  }
}

bool isShift(const ReadAs& one) {
  return anyPart(one.convention,
                 [](const Convention& part) { return part.kind == ConventionKind::kTorqueShift; });
}

// Whether every size of a shift, from none to the farthest, explains as much.
bool isAnyShift(const ReadAs& one, const Reading& given, double step_s) {
  const auto& [first_s, last_s] = one.convention.range;
  return isShift(one) && asGood({.convention = {}, .reading = given}, one) && first_s < step_s &&
         last_s > -step_s && std::max(-first_s, last_s) > kFarthestShift_s - step_s;
}

// A column that is shifted leaves no sinusoid that is not in the motion. Where such a one is left, and says
// as much as a shift does, it is a person's tremor.
void dropWhatATremorSays(const Reader& reader, const Reading& given, std::vector<ReadAs>& all) {
  if (std::none_of(all.begin(), all.end(), isShift)) {
    return;
  }
  const std::vector<double> tremor = reader.errorBesideTremor();
  const double far = -std::log(kFarBetter);
  std::erase_if(all, [&](const ReadAs& one) {
    return isShift(one) && gain(given.error_with_effects, tremor) > far &&
           gain(tremor, one.reading.error) < far;
  });
}

}  // namespace

ColumnNames columnNames(const model::ModelDescription& model) {
  ColumnNames names{.joints = model.joints()};
  for (int joint = 0; joint < names.joints; ++joint) {
    names.slides.push_back(model::isPrismatic(model.mechanism, joint));
  }
  return names;
}

std::vector<ReadAs> readings(Reader& reader, const Reading& given, const ColumnNames& names, Extent extent) {
  constexpr Grid kShifts{
      .first = -kFarthestShift_s, .last = kFarthestShift_s, .step = 0.02, .resolution = 2e-3};
  constexpr Grid kZeros{.first = -std::numbers::pi,
                        .last = std::numbers::pi - 0.1,
                        .step = std::numbers::pi / 9.0,
                        .resolution = 2e-3,
                        .turns = true};
  const Grid kStepUp{
      .first = std::log(kOtherLeg), .last = std::log(kLargestGear), .step = 0.4, .resolution = 0.1};
  const Grid kStepDown{.first = -kStepUp.last, .last = -kStepUp.first, .step = 0.4, .resolution = 0.1};
  std::vector<ReadAs> all;
  const bool together = extent == Extent::kAllTogether && names.joints > 1;
  const auto add = [&](std::vector<Convention> conventions) {
    for (Convention& convention : conventions) {
      if (together && (convention.joint != kAllJoints || convention.exchanged[0] >= 0)) {
        continue;
      }
      Reading reading = reader.read(convention);
      all.push_back({.convention = std::move(convention), .reading = std::move(reading)});
    }
  };
  const auto addBest = [&](const Grid& grid,
                           const std::function<Convention(double, const Range&)>& convention) {
    if (std::optional<ReadAs> best = bestOn(grid, reader, given, convention)) {
      all.push_back(std::move(*best));
    }
  };
  add(knownConventions(names));
  for (const int joint : together ? std::vector{kAllJoints} : eachAndAll(names.joints)) {
    add(torqueUnits(names, joint));
    for (const Grid& gears : {kStepUp, kStepDown}) {
      addBest(gears, [&](double logarithm, const Range& range) {
        return gearConvention(names, joint, std::exp(logarithm), {std::exp(range[0]), std::exp(range[1])});
      });
    }
    addBest(kShifts, [&](double late_s, const Range& range_s) {
      return shiftConvention(names, joint, late_s, range_s);
    });
    if (joint >= 0 && names.turns(joint)) {
      addBest(kZeros,
              [&](double offset_rad, const Range&) { return zeroConvention(names, joint, offset_rad); });
    }
  }
  std::erase_if(all, [&](const ReadAs& one) {
    const double number = one.convention.number;
    return isAnyShift(one, given, kShifts.step) ||
           (one.convention.kind == ConventionKind::kZero && std::abs(number) < kLeastZero_rad) ||
           (one.convention.kind == ConventionKind::kTorqueShift && number > -kSlowDrive_s &&
            number < kLeastShift_s);
  });
  return all;
}

std::vector<ReadAs> wrongConventions(Reader& reader, const Reading& given, const ColumnNames& names) {
  if (!reader.moves() ||
      std::all_of(given.error.begin(), given.error.end(), [](double error) { return error < kFloor; })) {
    return {};
  }
  const std::vector<ReadAs> all = readings(reader, given, names);
  std::vector<ReadAs> wrong;
  std::copy_if(all.begin(), all.end(), std::back_inserter(wrong),
               [&](const ReadAs& one) { return isBelieved(one, given); });
  dropWhatATremorSays(reader, given, wrong);
  keepBest(wrong, given);
  if (wrong.empty() ? !leavesAsMachines(given) : !leavesAsMachines(wrong.front().reading)) {
    std::vector<ReadAs> pairs = believedPairs(reader, given, names, all);
    dropWhatATremorSays(reader, given, pairs);
    keepBest(pairs, given);
    if (!pairs.empty() &&
        (wrong.empty() || gainOf(pairs.front(), given) > gainOf(wrong.front(), given) + leastGainOfPair())) {
      return pairs;
    }
  }
  return wrong;
}

void requireConventions(const Recording& recording, const model::ModelDescription& model) {
  const ColumnNames names = columnNames(model);
  Dataset data(std::span(&recording, 1), kCoarse);
  Reader reader(data, model);
  Reading given = reader.asGiven();
  std::vector<ReadAs> wrong = wrongConventions(reader, given, names);
  // Dry friction that holds a joint answers its drive up to its level, as no model tells and as a wrong
  // column might: rows at which a joint sticks say nothing of conventions.
  if (!wrong.empty() && data.leaveOutRest(stickingJoints(data, model, {}, {}))) {
    Reader moving(data, model);
    given = moving.asGiven();
    wrong = wrongConventions(moving, given, names);
  }
  addMounting(data, model, given, wrong);
  if (wrong.empty()) {
    return;
  }
  const ReadAs& best = wrong.front();
  // The joint that it changes most.
  std::size_t joint = 0;
  const auto better = [&](std::size_t j) {
    return given.error[j] / std::hypot(best.reading.error[j], kFloor);
  };
  for (std::size_t j = 1; j < given.error.size(); ++j) {
    joint = better(j) > better(joint) ? j : joint;
  }
  const std::vector<Convention> conventions = conventionsOf(wrong);
  throw WrongConvention(
      fmt::format("{}:{}: with {} the model leaves {:.0f} % of joint {}'s torque, as given {:.0f} %",
                  recording.name, told(conventions), best.convention.change,
                  kPercent * best.reading.error[joint], joint + 1, kPercent * given.error[joint]),
      conventions);
}

void requireAngles(const Recording& recording, const model::ModelDescription& model) {
  const ColumnNames names = columnNames(model);
  std::string beyond;
  double largest = 0.0;
  for (int joint = 0; joint < recording.joints; ++joint) {
    if (!names.turns(joint)) {
      continue;
    }
    const auto& q = recording.position_rad[static_cast<std::size_t>(joint)];
    const auto farthest =
        std::max_element(q.begin(), q.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    largest = std::max(largest, std::abs(*farthest));
    if (std::abs(*farthest) > kLargestAngle_rad) {
      beyond += fmt::format("{}q{}_rad is {:.4g} at {:.4g} s, expected within ±4π rad; is it in {}?",
                            beyond.empty() ? "" : "; ", joint + 1, *farthest,
                            recording.time_s[static_cast<std::size_t>(farthest - q.begin())],
                            likelyAngleUnit(std::abs(*farthest)));
    }
  }
  if (beyond.empty()) {
    return;
  }
  std::vector<Convention> smaller;
  // A machine may turn round and round, but not by what the model explains better in another unit.
  if (!recording.is_static) {
    constexpr double kDegrees = 180.0 / std::numbers::pi;
    Reader reader(Dataset(std::span(&recording, 1), kCoarse), model);
    smaller = smallerAngles(reader, names, largest > kLargestAngle_rad * kDegrees);
    if (smaller.empty()) {
      return;
    }
  }
  throw WrongConvention(fmt::format("{}: {}{}", recording.name, beyond, told(smaller)), smaller);
}

}  // namespace patella::diagnose
