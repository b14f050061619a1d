#include "tools/diagnose/fit/sticking.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "tools/diagnose/fit/predicted_torque.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/resting.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

/// Share of the time for which a joint rests.
double restOf(const Dataset& data, const RestingJoint& joint) {
  std::size_t resting = 0, all = 0;
  for (const Series& stretch : data.series()) {
    const std::vector<bool> rests = restingStates(stretch, joint);
    resting += static_cast<std::size_t>(std::count(rests.begin(), rests.end(), true));
    all += rests.size();
  }
  return static_cast<double>(resting) / static_cast<double>(all);
}

Column unexplained(Dataset data, const TorquePrediction& prediction) {
  prediction.predict(data);
  return data.driveTorque() -
         data.column([](const Series& series, std::size_t i) { return series.states[i].torque_Nm; });
}

double squareOf(const Dataset& data, const Column& column, int joint) {
  return column.segment(joint * data.rows(), data.rows()).squaredNorm();
}

}  // namespace

std::vector<RestingJoint> stickingJoints(const Dataset& data, const model::ModelDescription& model,
                                         std::span<const double> person_Nm, const FitOptions& options) {
  std::vector<RestingJoint> joints;
  for (int joint = 0; joint < data.joints() && !data.isStatic(); ++joint) {
    if (restOf(data, {.joint = joint}) > 0.0) {
      joints.push_back({.joint = joint});
    }
  }
  Dataset moving = data;
  if (!moving.leaveOutRest(joints) || moving.rows() == data.rows()) {
    return {};
  }
  const TorquePrediction prediction(moving, model, options);
  const Column left = unexplained(data, prediction);
  const Column left_in_motion = unexplained(moving, prediction);
  const Column torque = data.driveTorque();
  const auto rows_at_rest = static_cast<double>(data.rows() - moving.rows());
  std::erase_if(joints, [&](const RestingJoint& rests) {
    const int joint = rests.joint;
    const double in_motion_Nm = jointRms(moving, left_in_motion, joint);
    const double at_rest_Nm = std::sqrt(
        std::max(0.0, squareOf(data, left, joint) - squareOf(moving, left_in_motion, joint)) / rows_at_rest);
    const double pushes_Nm = person_Nm.empty() ? 0.0 : person_Nm[static_cast<std::size_t>(joint)];
    const double level_Nm = prediction.dryFriction_Nm(joint);
    return at_rest_Nm <
               std::max(resting::kTimesMotion * in_motion_Nm, std::sqrt(unknown::kPush) * pushes_Nm) ||
           at_rest_Nm < resting::kLeastOfLoad * jointRms(data, torque, joint) ||
           at_rest_Nm < resting::kLeastOfLevel * level_Nm || at_rest_Nm > resting::kTimesLevel * level_Nm;
  });
  return joints;
}

std::vector<RestingJoint> restingJoints(const Dataset& data, const model::ModelDescription& model,
                                        std::span<const double> person_Nm, const FitOptions& options) {
  std::vector<RestingJoint> joints = stickingJoints(data, model, person_Nm, options);
  for (std::size_t joint = 0; joint < person_Nm.size() && !data.isStatic(); ++joint) {
    const RestingJoint pushed{.joint = static_cast<int>(joint), .pushed = true};
    std::vector<RestingJoint> more = joints;
    std::erase_if(more, [&](const RestingJoint& rests) { return rests.joint == pushed.joint; });
    more.push_back(pushed);
    if (person_Nm[joint] > 0.0 && restOf(data, pushed) >= resting::kPushedLeast &&
        Dataset(data).leaveOutRest(more)) {
      joints = std::move(more);
    }
  }
  return joints;
}

}  // namespace patella::diagnose
