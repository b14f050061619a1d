// A plan as the loop, programs and people read it.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "tools/diagnose/plan/motion_plan.hpp"
#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// Where a plan came from.
struct PlanOrigin {
  std::vector<InputFile> inputs;  ///< configuration, model, diagnosis
  std::string limits;             ///< "of run.toml"
  std::string run_command;        ///< that runs the motion
};

/// What console and page say of a plan.
struct PlanWords {
  std::string motion;  ///< "A motion of 20 s for all base parameters."
  std::string use;     ///< "100 % of the range, 100 % of the speed and 74 % of the torque"
  std::string noise;   ///< "0.0079 and 0.005 N·m"
};
PlanWords planWords(const MotionPlan& plan, const PlanRequest& request);

/// What `patella run --reference` takes, under a comment that says what it is.
std::string planReference(const MotionPlan& plan, const PlanRequest& request, const PlanOrigin& origin);
/// plan.json: limits, motion, what it takes of the limits, and each effect's smallest size.
std::string planJson(const MotionPlan& plan, const PlanRequest& request, const PlanOrigin& origin);
/// One HTML page that needs nothing beside it: what it is for, the motion with its limits, and what it would
/// reveal. Throws std::runtime_error where gnuplot is missing or fails.
std::string planPage(const MotionPlan& plan, const PlanRequest& request, const PlanOrigin& origin);
/// What was planned, what of the limits it takes, and a table of sizes.
void printPlan(const MotionPlan& plan, const PlanRequest& request, const std::filesystem::path& folder,
               std::ostream& out);

}  // namespace patella::diagnose
