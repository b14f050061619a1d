#include "tools/diagnose/checks/convention_search.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/regression/judgement_limits.hpp"

namespace patella::diagnose {
namespace {

using namespace convention;

constexpr int kAll = -1;

/// A number on a grid, then between its best neighbours.
struct Grid {
  double first = 0.0, last = 0.0, step = 0.0, resolution = 0.0;
};

ReadAs bestOn(const Grid& grid, const Reader& reader, const std::function<Convention(double)>& convention) {
  ReadAs best{.convention = {}, .reading = {}};
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](double number) {
    ReadAs tried{.convention = convention(number), .reading = {}};
    tried.reading = reader.read(tried.convention);
    if (tried.reading.misfit() < least) {
      least = tried.reading.misfit();
      best = std::move(tried);
    }
  };
  for (double number = grid.first; number <= grid.last; number += grid.step) {
    consider(number);
  }
  for (double step = 0.5 * grid.step; step > grid.resolution; step *= 0.5) {
    const double centre = best.convention.number;
    consider(centre - step);
    consider(centre + step);
  }
  return best;
}

std::vector<int> eachAndAll(int joints) {
  std::vector<int> chosen;
  for (int joint = joints > 1 ? kAll : 0; joint < joints; ++joint) {
    chosen.push_back(joint);
  }
  return chosen;
}

double percentExplained(double error) {
  constexpr double kPercent = 100.0;
  return kPercent * (1.0 - error * error);
}

}  // namespace

ColumnNames columnNames(const app::ModelDescription& model) {
  return {.joints = model.joints(),
          .revolute = !std::holds_alternative<model::PrismaticJointParameters>(model.mechanism)};
}

std::vector<ReadAs> readings(const Reader& reader, const ColumnNames& names) {
  constexpr Grid kShifts{
      .first = -kFarthestShift_s, .last = kFarthestShift_s, .step = 0.02, .resolution = 2e-3};
  constexpr Grid kZeros{.first = -std::numbers::pi,
                        .last = std::numbers::pi - 0.1,
                        .step = std::numbers::pi / 9.0,
                        .resolution = 0.02};
  std::vector<ReadAs> all;
  for (Convention& convention : knownConventions(names)) {
    Reading reading = reader.read(convention);
    all.push_back({.convention = std::move(convention), .reading = std::move(reading)});
  }
  for (const int joint : eachAndAll(names.joints)) {
    all.push_back(
        bestOn(kShifts, reader, [&](double late_s) { return shiftConvention(names, joint, late_s); }));
    if (joint >= 0 && names.revolute) {
      all.push_back(bestOn(kZeros, reader,
                           [&](double offset_rad) { return zeroConvention(names, joint, offset_rad); }));
    }
  }
  const std::vector<double> factors = reader.torqueFactors();
  for (std::size_t j = 0; j < factors.size(); ++j) {
    for (const int joint : {names.joints > 1 ? kAll : 0, static_cast<int>(j)}) {
      for (Convention& convention : scaleConventions(names, joint, factors[j])) {
        Reading reading = reader.read(convention);
        all.push_back({.convention = std::move(convention), .reading = std::move(reading)});
      }
    }
  }
  std::erase_if(all, [](const ReadAs& one) {
    const double size = std::abs(one.convention.number);
    return (one.convention.kind == ConventionKind::kZero && size < kLeastZero_rad) ||
           (one.convention.kind == ConventionKind::kTorqueShift && size < kLeastShift_s);
  });
  return all;
}

std::vector<ReadAs> wrongConventions(const Reader& reader, const ColumnNames& names) {
  const Reading given = reader.asGiven();
  if (std::all_of(given.error.begin(), given.error.end(), [](double error) { return error < kFloor; })) {
    return {};
  }
  std::vector<ReadAs> all = readings(reader, names);
  std::erase_if(all, [&](const ReadAs& one) {
    for (std::size_t j = 0; j < given.error.size(); ++j) {
      if (one.reading.error[j] > kExplained && one.reading.error[j] < kFarBetter * given.error[j]) {
        return true;
      }
    }
    return one.reading.misfit() > given.misfit() + std::log(kFarBetter);
  });
  if (all.empty()) {
    return {};
  }
  std::sort(all.begin(), all.end(),
            [](const ReadAs& a, const ReadAs& b) { return a.reading.misfit() < b.reading.misfit(); });
  if (all.front().reading.misfit() > reader.withEffects().misfit() + std::log(kAgainstEffects)) {
    return {};
  }
  const double as_good = all.front().reading.misfit() + std::log(kAsGood);
  std::erase_if(all, [&](const ReadAs& one) { return one.reading.misfit() > as_good; });
  return all;
}

void requireConventions(const Recording& recording, const app::ModelDescription& model) {
  const Reader reader(Dataset(std::span(&recording, 1), kCoarse), model);
  const std::vector<ReadAs> wrong = wrongConventions(reader, columnNames(model));
  if (wrong.empty()) {
    return;
  }
  const ReadAs& best = wrong.front();
  const Reading given = reader.asGiven();
  // Of the joint that it changes most.
  std::size_t joint = 0;
  const auto better = [&](std::size_t j) {
    return given.error[j] / std::hypot(best.reading.error[j], kFloor);
  };
  for (std::size_t j = 1; j < given.error.size(); ++j) {
    joint = better(j) > better(joint) ? j : joint;
  }
  std::vector<Convention> conventions;
  std::string look;
  for (const ReadAs& one : wrong) {
    const std::string name = fmt::format("{} ({})", one.convention.mistake, one.convention.change);
    if (look.find(name) == std::string::npos) {
      look += (look.empty() ? "" : ", or ") + name;
      conventions.push_back(one.convention);
    }
  }
  throw WrongConvention(
      fmt::format("{}: looks like {}: with {} the model explains {:.0f} % of the torque of joint {}, as "
                  "given {:.0f} %",
                  recording.name, look, best.convention.change, percentExplained(best.reading.error[joint]),
                  joint + 1, percentExplained(given.error[joint])),
      conventions);
}

void requireAngles(const Recording& recording, const app::ModelDescription& model) {
  const ColumnNames names = columnNames(model);
  std::string beyond;
  std::vector<Convention> conventions;
  for (int joint = 0; joint < recording.joints && names.revolute; ++joint) {
    const auto& q = recording.position_rad[static_cast<std::size_t>(joint)];
    const auto farthest =
        std::max_element(q.begin(), q.end(), [](double a, double b) { return std::abs(a) < std::abs(b); });
    if (std::abs(*farthest) > kLargestAngle_rad) {
      beyond += fmt::format("{}q{}_rad is {:.4g} at {:.4g} s, expected within ±4π rad; is it in {}?",
                            beyond.empty() ? "" : "; ", joint + 1, *farthest,
                            recording.time_s[static_cast<std::size_t>(farthest - q.begin())],
                            likelyAngleUnit(std::abs(*farthest)));
      conventions.push_back({.kind = ConventionKind::kPositionUnit, .joint = joint});
    }
  }
  if (beyond.empty()) {
    return;
  }
  // A machine may turn round and round, but not by what the model explains better in another unit.
  if (!recording.is_static) {
    const Reader reader(Dataset(std::span(&recording, 1), kCoarse), model);
    const double given = reader.asGiven().misfit();
    bool better = false;
    for (const Convention& convention : knownConventions(names)) {
      better = better || (convention.kind == ConventionKind::kPositionUnit && convention.number > 1.0 &&
                          reader.read(convention).misfit() < given);
    }
    if (!better) {
      return;
    }
  }
  throw WrongConvention(fmt::format("{}: {}", recording.name, beyond), conventions);
}

}  // namespace patella::diagnose
