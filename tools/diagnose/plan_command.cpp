#include "tools/diagnose/plan_command.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <unistd.h>

#include "core/bounds/bounds.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "tools/diagnose/output/answer.hpp"
#include "tools/diagnose/output/plan_files.hpp"
#include "tools/diagnose/output/result_folder.hpp"
#include "tools/diagnose/plan/motion_plan.hpp"
#include "tools/diagnose/plan/repair.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"

namespace patella::diagnose {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  bool plan = false;
  fs::path config, model, from, out;
  std::vector<std::string> effects;
  std::vector<double> q_min_rad, q_max_rad, velocity_rad_s, torque_Nm, start_rad, noise_Nm, person_Nm,
      reach_m;
  PlanTiming timing;
  DesignOptions design;
  double nominal_tolerance = runaway::kTolerance;
};

void declare(CLI::App& app, Arguments& a) {
  app.footer("Exit status: 0 where a motion was planned; 1 after an error.");
  app.set_version_flag("--version", std::string("patella-diagnose ") + PATELLA_VERSION);
  app.add_flag("--plan", a.plan, "plan a motion");
  app.add_option("--config", a.config,
                 "configuration of the loop: its model, the limits of [safety], the start of [rig]");
  app.add_option("--model", a.model, "model file, in place of the configuration's");
  app.add_option("--out", a.out, "folder for reference.toml, plan.json and plan.html")->required();
  app.add_option("--from", a.from,
                 "diagnosis.json: plan for the effects that its recording could not tell, against its noise");
  app.add_option(
         "--effects", a.effects,
         "effects to show, separated by commas: kinds, with @JOINT on one joint only; all: those of the "
         "library and the base parameters; none: the base parameters alone; all, or what --from has, "
         "unless given")
      ->delimiter(',');
  app.add_option("--duration", a.timing.duration_s, "s of motion, the blend included")
      ->check(options::numberFrom(2.0, 600.0))
      ->capture_default_str();
  app.add_option("--blend", a.timing.blend_s, "s in which the motion takes over from the start")
      ->check(options::numberFrom(boundOf("reference.blend_s").minimum, boundOf("reference.blend_s").maximum))
      ->capture_default_str();
  app.add_option(
         "--harmonics", a.timing.harmonics,
         fmt::format(
             "sines of each joint; as many as there are up to --highest, but {} at most, unless given",
             kUsualHarmonics))
      ->check(
          patella::options::wholeNumberFrom(1, static_cast<int>(control::MultisineMotion::kMaxComponents)));
  app.add_option("--highest", a.timing.highest_Hz, "Hz of the fastest sine")
      ->check(options::numberFrom(0.05, boundOf("reference.joint.frequency_Hz").maximum))
      ->capture_default_str();
  const auto list = [&](const char* name, std::vector<double>& values, const char* what) {
    app.add_option(name, values, what)->delimiter(',');
  };
  list("--q-min", a.q_min_rad, "rad, one for each joint, in place of the configuration's");
  list("--q-max", a.q_max_rad, "rad, likewise");
  list("--velocity", a.velocity_rad_s, "rad/s, likewise");
  list("--torque-limit", a.torque_Nm, "N·m, likewise");
  list("--start", a.start_rad,
       "rad, pose at activation; that of [rig], or the middle of the ranges without one, unless given");
  list("--reach", a.reach_m,
       "m that the end point may go from where it is at the start: lowest and highest of each axis, as in "
       "-0.2,0.3,-0.1,0.4; anywhere unless given");
  list(
      "--noise", a.noise_Nm,
      "N·m, rms of each joint's torque that no model explains; the diagnosis', or 0.2 % of the torque limit, "
      "unless given");
  list("--person", a.person_Nm,
       "N·m, rms of what a person will push each joint with, beside the noise; nobody pushes unless given");
  app.add_option("--nominal-tolerance", a.nominal_tolerance,
                 "standard deviation, relative, by which the model's parameters may be wrong")
      ->check(options::numberFrom(1e-4, 1.0))
      ->capture_default_str();
  app.add_option("--evaluations", a.design.evaluations, "motions that the search looks at")
      ->check(patella::options::wholeNumberFrom(100, 1000000))
      ->capture_default_str();
  app.add_option("--seed", a.design.seed, "of everything that is drawn by lot")
      ->check(patella::options::wholeNumberFrom(0, std::numeric_limits<std::int64_t>::max()))
      ->capture_default_str();
}

const char* const kWhat =
    "Plans a motion from a recording of which patella-diagnose can tell named effects, or all parameters, "
    "and "
    "writes it as a reference of the loop.";

void requireCount(const char* option, const std::vector<double>& values, int joints) {
  if (!values.empty() && values.size() != static_cast<std::size_t>(joints)) {
    throw std::invalid_argument(fmt::format("{}: {} values, expected {}, one for each joint of the model",
                                            option, values.size(), joints));
  }
}

// The option, or that it stands for the configuration's value.
std::string nameOf(const char* option, const std::vector<double>& given) {
  return given.empty() ? fmt::format("{} (as configured)", option) : option;
}

// What the command line gives in place of the configuration's.
void setLimits(const Arguments& a, bool configured, PlanRequest& request) {
  struct Given {
    const char* option;
    Bound bound;
    const std::vector<double>& values;
    double safety::JointLimits::*limit;
  };
  const std::vector<Given> all{
      {"--q-min", boundOf("safety.q_min_rad"), a.q_min_rad, &safety::JointLimits::q_min_rad},
      {"--q-max", boundOf("safety.q_max_rad"), a.q_max_rad, &safety::JointLimits::q_max_rad},
      {"--velocity", boundOf("safety.velocity_rad_s"), a.velocity_rad_s,
       &safety::JointLimits::velocity_rad_s},
      {"--torque-limit", boundOf("safety.torque_Nm"), a.torque_Nm, &safety::JointLimits::torque_Nm}};
  for (const Given& given : all) {
    requireCount(given.option, given.values, request.model.joints());
    if (given.values.empty() && !configured) {
      throw std::invalid_argument(
          fmt::format("{}: not given, expected one value for each joint, or --config", given.option));
    }
    for (std::size_t j = 0; j < given.values.size(); ++j) {
      requireBound(given.bound, given.values[j], fmt::format("{} of joint {}", given.option, j + 1));
      request.limits.joint[j].*given.limit = given.values[j];
    }
  }
  for (int j = 0; j < request.model.joints(); ++j) {
    const safety::JointLimits& limit = request.limits.joint[static_cast<std::size_t>(j)];
    if (!(limit.q_min_rad < limit.q_max_rad)) {
      throw std::invalid_argument(fmt::format("{} of joint {}: value {}, expected less than {}, {}",
                                              nameOf("--q-min", a.q_min_rad), j + 1, limit.q_min_rad,
                                              nameOf("--q-max", a.q_max_rad), limit.q_max_rad));
    }
  }
}

// A start that takes more torque than a plan may ask for leaves no motion at all.
void requireHold(const Arguments& a, const PlanRequest& request) {
  const JointVector rest = JointVector::Zero(request.model.joints());
  const JointVector hold_Nm = TorqueAlong(request.model).at(request.start_rad, rest, rest, 0.0, true);
  for (int j = 0; j < request.model.joints(); ++j) {
    const double limit_Nm = request.limits.joint[static_cast<std::size_t>(j)].torque_Nm;
    const double needed_Nm = std::abs(hold_Nm[j]) / kTorqueShare;
    const std::string unit = unitsOf(request.model.mechanism, j).torque;
    constexpr double kDigits = 100.0;  // of the least limit, which is not rounded down
    if (limit_Nm < needed_Nm) {
      throw std::invalid_argument(fmt::format(
          "{} of joint {}: value {} {}, expected at least {:g} {}: to hold the start at {:.3g} takes "
          "{:.3g} {}, and a plan may take {:.0f} % of the limit",
          nameOf("--torque-limit", a.torque_Nm), j + 1, limit_Nm, unit,
          std::ceil(kDigits * needed_Nm) / kDigits, unit, request.start_rad[j], std::abs(hold_Nm[j]), unit,
          kPercent * kTorqueShare));
    }
  }
}

void setStart(const Arguments& a, const std::vector<double>& configured, PlanRequest& request) {
  const int joints = request.model.joints();
  requireCount("--start", a.start_rad, joints);
  request.start_rad.resize(joints);
  for (int j = 0; j < joints; ++j) {
    const auto index = static_cast<std::size_t>(j);
    const safety::JointLimits& limit = request.limits.joint[index];
    request.start_rad[j] = !a.start_rad.empty()        ? a.start_rad[index]
                           : index < configured.size() ? configured[index]
                                                       : 0.5 * (limit.q_min_rad + limit.q_max_rad);
  }
}

void setReach(const Arguments& a, PlanRequest& request) {
  if (a.reach_m.empty()) {
    return;
  }
  const Eigen::Index axes = model::makeModel(request.model).mechanism().dimensions();
  if (a.reach_m.size() != static_cast<std::size_t>(2 * axes)) {
    throw std::invalid_argument(fmt::format("--reach: {} values, expected {}: lowest and highest of {} axes",
                                            a.reach_m.size(), 2 * axes, axes));
  }
  Reach reach{.lowest_m = SpaceVector(axes), .highest_m = SpaceVector(axes)};
  for (Eigen::Index k = 0; k < axes; ++k) {
    reach.lowest_m[k] = a.reach_m[static_cast<std::size_t>(2 * k)];
    reach.highest_m[k] = a.reach_m[static_cast<std::size_t>(2 * k + 1)];
    if (!(reach.lowest_m[k] < 0.0 && reach.highest_m[k] > 0.0)) {
      throw std::invalid_argument(
          fmt::format("--reach of axis {}: {} to {} m, expected less than 0 to more than 0, as the start is "
                      "within",
                      k + 1, reach.lowest_m[k], reach.highest_m[k]));
    }
  }
  request.reach = reach;
}

void setNoise(const Arguments& a, std::vector<NoiseOfJoint> known, PlanRequest& request) {
  /// A recording without any noise has the last bit of its numbers.
  constexpr double kLeast = 1e-6;
  requireCount("--noise", a.noise_Nm, request.model.joints());
  requireCount("--person", a.person_Nm, request.model.joints());
  request.noise = std::move(known);
  request.noise.resize(static_cast<std::size_t>(request.model.joints()));
  for (std::size_t j = 0; j < request.noise.size(); ++j) {
    const double limit_Nm = request.limits.joint[j].torque_Nm;
    double& noise_Nm = request.noise[j].noise_Nm;
    if (!a.noise_Nm.empty()) {
      request.noise[j] = {.noise_Nm = a.noise_Nm[j], .structure_Nm = 0.0};
      if (!(noise_Nm > 0.0 && noise_Nm < limit_Nm)) {
        throw std::invalid_argument(
            fmt::format("--noise of joint {}: value {}, expected more than 0 and less "
                        "than its torque limit {}",
                        j + 1, noise_Nm, limit_Nm));
      }
    } else if (noise_Nm == 0.0) {
      noise_Nm = kUsualNoise * limit_Nm;
    }
    noise_Nm = std::max(noise_Nm, kLeast * limit_Nm);
    if (!a.person_Nm.empty()) {
      if (!(a.person_Nm[j] >= 0.0 && a.person_Nm[j] < limit_Nm)) {
        throw std::invalid_argument(fmt::format(
            "--person of joint {}: value {}, expected 0 or more and less than its torque limit {}", j + 1,
            a.person_Nm[j], limit_Nm));
      }
      noise_Nm = std::hypot(noise_Nm, std::sqrt(kIndependent_Hz / kPushes_Hz) * a.person_Nm[j]);
      request.noise[j].pushed = a.person_Nm[j] > 0.0;
    }
  }
}

InputFile input(const fs::path& path) {
  return {.path = path.string(), .sha256 = app::fileSha256(path)};
}

// Everything that a plan needs, from files and options.
PlanRequest requestOf(const Arguments& a, PlanOrigin& origin) {
  PlanRequest request;
  request.timing = a.timing;
  request.design = a.design;
  request.nominal_tolerance = a.nominal_tolerance;
  std::vector<double> start;
  if (!a.config.empty()) {
    app::CommandLine line;
    line.config = a.config;
    if (!a.model.empty()) {
      line.model = a.model;
    }
    const app::RunConfig config = app::loadRunConfig(line);
    request.model = config.model;
    request.limits = config.tick.limits;
    request.design.rate_Hz = config.loop.rate_Hz;
    start = config.rig.initial_q_rad;
    origin.inputs.push_back(input(a.config));
    origin.inputs.push_back(input(config.model_path));
  } else if (!a.model.empty()) {
    request.model = app::loadModel(a.model);
    origin.inputs.push_back(input(a.model));
  } else {
    throw std::invalid_argument("--plan: neither --config nor --model, expected one of them");
  }
  origin.run_command = runCommandLine(a.config, a.out);
  origin.limits = a.config.empty() ? "of the command line" : "of " + a.config.filename().string();
  setLimits(a, !a.config.empty(), request);
  setStart(a, start, request);
  requireHold(a, request);
  setReach(a, request);
  Unrevealed unrevealed;
  if (!a.from.empty()) {
    unrevealed = readUnrevealed(a.from, request.model.joints());
    origin.inputs.push_back(input(a.from));
  }
  setNoise(a, std::move(unrevealed.noise), request);
  request.effects = !a.effects.empty() ? a.effects
                    : !a.from.empty()  ? unrevealed.effects
                                       : std::vector<std::string>{"all"};
  for (const char* word : {"all", "none"}) {
    if (request.effects.size() > 1 &&
        std::find(request.effects.begin(), request.effects.end(), word) != request.effects.end()) {
      throw std::invalid_argument(fmt::format("--effects: '{}' among others, expected it alone", word));
    }
  }
  return request;
}

void run(const Arguments& a) {
  constexpr auto kPatience = std::chrono::seconds(2);
  PlanOrigin origin;
  PlanRequest request = requestOf(a, origin);
  ResultFolder folder(a.out);
  ProgressLine progress(std::cerr, isatty(STDERR_FILENO) == 1);
  const auto start = std::chrono::steady_clock::now();
  const auto shown = [&](const char* stage) {
    return [&, stage](double fraction) {
      if (std::chrono::steady_clock::now() - start > kPatience) {
        progress.at(stage, fraction);
      }
    };
  };
  request.design.progress = shown("planning");
  request.bounding = shown("what any motion could tell");
  const MotionPlan plan = makePlan(request);
  progress.at("drawing", 0.0);
  folder.write({{"reference.toml", planReference(plan, request, origin)},
                {"plan.json", planJson(plan, request, origin)},
                {"plan.html", planPage(plan, request, origin)}});
  progress.clear();
  printPlan(plan, request, a.out, std::cout);
}

}  // namespace

bool asksForPlan(int argc, const char* const* argv) {
  return std::any_of(argv, argv + argc,
                     [](const char* argument) { return std::string_view(argument) == "--plan"; });
}

std::string planHelp() {
  CLI::App app(kWhat, "patella-diagnose --plan");
  Arguments arguments;
  declare(app, arguments);
  return app.help();
}

int runPlan(int argc, char** argv) {
  CLI::App app(kWhat, "patella-diagnose --plan");
  Arguments arguments;
  declare(app, arguments);
  return patella::options::runProgram(app, argc, argv, [&] { run(arguments); });
}

}  // namespace patella::diagnose
