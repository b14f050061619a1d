#include "tools/diagnose/checks/convention_score.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace patella::diagnose {
namespace {

using namespace convention;

bool scalesTorqueOf(const Convention& convention, std::size_t joint) {
  return convention.kind == ConventionKind::kTorqueUnit &&
         (convention.joint == kAllJoints || convention.joint == static_cast<int>(joint));
}

bool scalesTorque(const Convention& convention) {
  return anyPart(convention, [](const Convention& part) { return part.kind == ConventionKind::kTorqueUnit; });
}

// The smaller a torque is, the less there is to leave: one that is scaled has to be explained far better
// itself, or what was left, beside plain effects too, to be out of all proportion to the load. Beside another
// convention it has to be explained itself: the other one may make a motion that needs no torque.
bool explainsItself(const ReadAs& one, const Reading& given) {
  if (one.convention.parts.empty() &&
      gain(given.error_with_effects, one.reading.error, kAsMachines) > -std::log(kSpeaks)) {
    return true;
  }
  for (std::size_t j = 0; j < given.error_of_torque.size(); ++j) {
    if (anyPart(one.convention, [j](const Convention& part) { return scalesTorqueOf(part, j); }) &&
        std::hypot(one.reading.error_of_torque[j], kFloor) <
            kFarBetter * std::hypot(given.error_of_torque[j], kFloor)) {
      return true;
    }
  }
  return false;
}

// The least that a convention has to gain. Where a torque is read in another way, plain effects on a joint
// that it does not explain say nothing against it.
double leastGainOf(const ReadAs& one, const Reading& given) {
  double of_effects = 0.0;
  for (std::size_t j = 0; j < given.error.size(); ++j) {
    if (!one.convention.torque_only || one.reading.error[j] < kFarBetter * given.error[j]) {
      of_effects += gain({given.error[j]}, {given.error_with_effects[j]});
    }
  }
  return std::max(-std::log(kFarBetter), kOfEffects * of_effects);
}

bool losesMost(double read, double given) {
  return std::hypot(read, kFloor) < kSpeaks * std::hypot(given, kFloor);
}

// Every joint that the convention changes is explained by it. And some joint speaks for it: one of which more
// is left than a model of the machine would leave, that loses so much of it as chance does not take, or more
// than to plain effects, or whose torque is explained once scaled. Two conventions at once have to leave what
// machines leave: chance finds too many pairs that take a part.
bool explains(const ReadAs& one, const Reading& given) {
  const Reading& read = one.reading;
  const double part = one.convention.parts.empty() ? kSmallPart : 0.0;
  bool speaks = false;
  for (std::size_t j = 0; j < given.error.size(); ++j) {
    if (read.error[j] < kFarBetter * given.error[j]) {
      if (read.error[j] > std::max(kAsMachines, part * given.error[j])) {
        return false;
      }
      const bool most_goes =
          read.error[j] < kSmallPart * given.error[j] && losesMost(read.error[j], given.error[j]);
      // A drive that is late is no plain effect, and explains what a shift does.
      const bool beyond_effects =
          !anyPart(one.convention, mayBeLateDrive) &&
          std::hypot(read.error[j], kFloor) < kFarBetter * std::hypot(given.error_with_effects[j], kFloor);
      speaks = speaks || given.error[j] > kOutOfProportion || most_goes || beyond_effects ||
               (scalesTorque(one.convention) && losesMost(read.error_of_torque[j], given.error_of_torque[j]));
    }
  }
  return speaks;
}

}  // namespace

double gain(const std::vector<double>& given, const std::vector<double>& read, double floor) {
  return misfit(given, floor) - misfit(read, floor);
}

double gainOf(const ReadAs& one, const Reading& given) {
  return scalesTorque(one.convention) && !explainsItself(one, given) ? std::numeric_limits<double>::lowest()
                                                                     : gain(given.error, one.reading.error);
}

double leastGainOfPair() {
  return -2.0 * std::log(kFarBetter);
}

bool leavesAsMachines(const Reading& reading) {
  return std::all_of(reading.error.begin(), reading.error.end(),
                     [](double error) { return error < kAsMachines; });
}

// Torques that are scaled are as good as each other where they leave as much over the torque.
bool asGood(const ReadAs& one, const ReadAs& best) {
  const double lost = gain(one.reading.error, best.reading.error);
  return lost < std::log(kAsGood) ||
         (leavesAsMachines(one.reading) &&
          lost < static_cast<double>(one.reading.error.size()) * std::log(kAsGoodOfMachines)) ||
         (scalesTorque(one.convention) && scalesTorque(best.convention) &&
          gain(best.reading.error_of_torque, one.reading.error_of_torque) > -std::log(kAsGood));
}

bool isBelieved(const ReadAs& one, const Reading& given) {
  return explains(one, given) && gainOf(one, given) >= leastGainOf(one, given) &&
         gain(one.reading.error, given.error_with_effects, kSensors) <=
             static_cast<double>(given.error.size()) * std::log(kTimesEffects);
}

}  // namespace patella::diagnose
