#include "tools/diagnose/fit/sticking.hpp"

#include <algorithm>
#include <cmath>

#include "tools/diagnose/fit/predicted_torque.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/resting.hpp"
#include "tools/diagnose/thresholds.hpp"

namespace patella::diagnose {
namespace {

std::vector<int> restAtTimes(const Dataset& data) {
  std::vector<int> joints;
  for (int joint = 0; joint < data.joints(); ++joint) {
    const auto series = data.series();
    if (std::any_of(series.begin(), series.end(), [joint](const Series& stretch) {
          const std::vector<bool> rests = restingStates(stretch, joint);
          return std::find(rests.begin(), rests.end(), true) != rests.end();
        })) {
      joints.push_back(joint);
    }
  }
  return joints;
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

std::vector<int> stickingJoints(const Dataset& data, const model::ModelDescription& model,
                                std::span<const double> person_Nm, const FitOptions& options) {
  std::vector<int> joints = data.isStatic() ? std::vector<int>{} : restAtTimes(data);
  Dataset moving = data;
  if (!moving.leaveOutRest(joints) || moving.rows() == data.rows()) {
    return {};
  }
  const TorquePrediction prediction(moving, model, options);
  const Column left = unexplained(data, prediction);
  const Column left_in_motion = unexplained(moving, prediction);
  const Column torque = data.driveTorque();
  const auto rows_at_rest = static_cast<double>(data.rows() - moving.rows());
  std::erase_if(joints, [&](int joint) {
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

}  // namespace patella::diagnose
