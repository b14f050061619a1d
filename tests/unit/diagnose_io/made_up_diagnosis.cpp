#include "tests/unit/diagnose_io/made_up_diagnosis.hpp"

#include <cmath>
#include <limits>
#include <random>

namespace patella::test {
namespace {

using namespace diagnose;

constexpr double kRate_Hz = 35.0;

struct Noise {
  std::mt19937_64 engine{3};
  double value = 0.0;

  double next() {
    // Correlated as behind a low-pass.
    value = 0.5 * value + 0.1 * (static_cast<double>(engine() >> 11) * 0x1p-53 - 0.5);
    return value;
  }
};

void appendRow(JointCurves& curves, Noise& noise, double time_s, int joint, bool heldout) {
  const double phase = 2.0 * time_s + 0.6 * std::sin(0.9 * time_s) + joint;
  const double rate = 2.0 + 0.54 * std::cos(0.9 * time_s);
  const double velocity = 0.6 * rate * std::cos(phase);
  curves.time_s.push_back(time_s);
  curves.position_rad.push_back(-0.8 + 0.6 * std::sin(phase));
  curves.velocity_rad_s.push_back(velocity);
  curves.acceleration_rad_s2.push_back(-0.6 * rate * rate * std::sin(phase));
  curves.torque_Nm.push_back(8.0 * std::sin(phase));
  const double rest = noise.next();
  const double missing =
      joint == 1 ? 1.5 * std::tanh(velocity / 0.05) + 4.0 * (curves.position_rad.back() + 0.4) : 0.0;
  curves.residual_before_Nm.push_back(missing + rest);
  curves.residual_after_Nm.push_back(rest);
  curves.heldout.push_back(heldout);
}

std::vector<JointCurves> someCurves() {
  std::vector<JointCurves> curves(2);
  Noise noise;
  for (const bool heldout : {false, true}) {
    for (const double length_s : {20.0, 12.0}) {  // two recordings
      const double from_s = heldout ? 0.7 * length_s : 0.3;
      const double to_s = heldout ? length_s : 0.7 * length_s;
      for (double time_s = from_s; time_s < to_s; time_s += 1.0 / kRate_Hz) {
        for (int joint = 0; joint < 2; ++joint) {
          appendRow(curves[static_cast<std::size_t>(joint)], noise, time_s, joint, heldout);
        }
      }
    }
  }
  return curves;
}

/// Windows of two recordings, simulated by a model that strays by this.
std::vector<SimulatedMotion> someMotion(double error_rad) {
  SimulatedMotion motion;
  for (const double from_s : {14.0, 14.5, 8.4, 8.9}) {
    for (double in_s = 0.0; in_s < 0.5; in_s += 0.02) {
      motion.time_s.push_back(from_s + in_s);
      motion.measured_rad.push_back(-0.8 + 0.6 * std::sin(2.0 * (from_s + in_s)));
      motion.simulated_rad.push_back(motion.measured_rad.back() + error_rad * in_s);
    }
    motion.time_s.push_back(motion.time_s.back());
    motion.measured_rad.push_back(std::nan(""));
    motion.simulated_rad.push_back(std::nan(""));
  }
  return {motion, motion};
}

std::vector<SelectionStep> someSteps() {
  return {{.ranking = {{.label = "linear_stiffness@2",
                        .gain = 2100.0,
                        .threshold = 9.5,
                        .accepted = true,
                        .refused_because = ""},
                       {.label = "coulomb_friction@2",
                        .gain = 1400.0,
                        .threshold = 9.5,
                        .accepted = false,
                        .refused_because = ""},
                       {.label = "viscous_friction@2",
                        .gain = 900.0,
                        .threshold = 9.5,
                        .accepted = false,
                        .refused_because = ""},
                       {.label = "payload@2",
                        .gain = 31.0,
                        .threshold = 9.5,
                        .accepted = false,
                        .refused_because = "sign: level_Nm"},
                       {.label = "torque_bias@1",
                        .gain = 1.2,
                        .threshold = 9.5,
                        .accepted = false,
                        .refused_because = ""}},
           .accepted = "linear_stiffness@2",
           .p_value = 0.002},
          {.ranking = {{.label = "coulomb_friction@2",
                        .gain = 880.0,
                        .threshold = 9.8,
                        .accepted = true,
                        .refused_because = ""},
                       {.label = "load_dependent_friction@2",
                        .gain = 640.0,
                        .threshold = 9.8,
                        .accepted = false,
                        .refused_because = ""}},
           .accepted = "coulomb_friction@2",
           .p_value = 0.002},
          {.ranking = {{.label = "presliding_hysteresis@2",
                        .gain = 12.0,
                        .threshold = 10.1,
                        .accepted = false,
                        .refused_because = "cross-validation"},
                       {.label = "rotor_inertia@1",
                        .gain = 6.0,
                        .threshold = 10.1,
                        .accepted = false,
                        .refused_because = "chance"}},
           .accepted = "",
           .p_value = 0.03}};
}

}  // namespace

Diagnosis madeUpDiagnosis() {
  Diagnosis d;
  d.verdict = Verdict::kEffectFound;
  d.explanation = "A spring and dry friction on joint 2 explain 98 % of what the model leaves over.";
  d.effects = {{.kind = "linear_stiffness",
                .joint = 1,
                .parameters = {{.name = "stiffness_Nm_rad", .value = 4.02, .ci95 = {3.91, 4.13}},
                               {.name = "rest_position_rad", .value = -0.402, .ci95 = {-0.421, -0.383}}},
                .p_value = 0.002,
                .gain = 1830.0,
                .indistinguishable_from = {},
                .replaces = {},
                .separating_motion = {}},
               {.kind = "coulomb_friction",
                .joint = 1,
                .parameters = {{.name = "level_Nm", .value = 1.48, .ci95 = {1.42, 1.54}}},
                .p_value = 0.002,
                .gain = 880.0,
                .indistinguishable_from = {"presliding_hysteresis", "viscous_friction@1+torque_bias"},
                .replaces = {"viscous_friction"},
                .separating_motion = "slow reversals of less than 0.05 rad"}};
  d.before = {.train_rms_Nm = {0.21, 2.31},
              .heldout_rms_Nm = {0.22, 2.4},
              .train_relative = {0.01, 0.31},
              .heldout_relative = {0.011, 0.32},
              .simulation_rms_rad = {0.002, 0.31},
              .simulated = someMotion(0.4)};
  d.refitted = {.train_rms_Nm = {0.2, 1.2},
                .heldout_rms_Nm = {0.21, 1.3},
                .train_relative = {0.01, 0.16},
                .heldout_relative = {0.01, 0.17},
                .simulation_rms_rad = {0.002, 0.11}};
  d.after = {.train_rms_Nm = {0.2, 0.05},
             .heldout_rms_Nm = {0.2, 0.06},
             .train_relative = {0.01, 0.007},
             .heldout_relative = {0.01, 0.008},
             .simulation_rms_rad = {0.002, std::numeric_limits<double>::quiet_NaN()},
             .simulated = someMotion(0.02)};
  d.noise_floor_Nm = {0.19, 0.05};
  d.simulation_window_s = 0.5;
  d.excitation = {.position_range_rad = {1.2, 1.2},
                  .velocity_rms_rad_s = {0.8, 0.85},
                  .identifiable = {"coulomb_friction@2", "linear_stiffness@2"},
                  .not_identifiable = {"torque_gain@1"}};
  d.revealed = {{.kind = "payload",
                 .joint = 1,
                 .parameter = "mass_kg",
                 .smallest_size = 0.8,
                 .parameters = {0.8, 0.3},
                 .torque_rms_Nm = 0.4,
                 .share_of_torque = 0.1}};
  d.unexplained = {{.joint = 0, .variable = "ddq1*q1", .explained_Nm = 0.02, .p_value = 0.02}};
  d.nominal = {{.name = "mass_kg.1",
                .nominal = 7.2,
                .refitted = 7.31,
                .sd = 0.08,
                .known_sd = 0.73,
                .tolerated = {5.9, 8.8}}};
  d.correlations = {
      .parameters = {"mass_kg[1]", "linear_stiffness@2 stiffness_Nm_rad", "coulomb_friction@2 level_Nm"},
      .matrix = {{1.0, 0.95, 0.1}, {0.95, 1.0, -0.3}, {0.1, -0.3, 1.0}}};
  d.runaways = {{.what = "coulomb_friction@2 level_Nm",
                 .nominal = std::numeric_limits<double>::quiet_NaN(),
                 .refitted = 1.48,
                 .limit = 0.0,
                 .words = "coulomb friction on joint 2: level <may be> zero"},
                {.what = "mass_kg.1",
                 .nominal = 7.2,
                 .refitted = 7.31,
                 .limit = 0.01,
                 .words = "the model's mass left its tolerance"}};
  d.drive_timing = {{.joint = 1,
                     .delay_s = 0.003,
                     .lag_s = 0.008,
                     .relative_error_before = 0.11,
                     .relative_error_after = 0.02}};
  d.steps = someSteps();
  d.warnings = {"run.csv: torque of joint 1 is clipped at 12 N·m in 3.2 % of the recording"};
  d.curves = someCurves();
  d.curves_rate_Hz = kRate_Hz;
  d.seed = 7;
  d.extended.mechanism = model::PlanarTwoLinkParameters{
      .mass_kg = {7.3, 4.4}, .length_m = {0.4, 0.4}, .com_m = {0.17, 0.24}, .inertia_kg_m2 = {0.12, 0.12}};
  d.extended.effects = {{.kind = "linear_stiffness", .joint = 1, .parameters = {4.02, -0.402}},
                        {.kind = "coulomb_friction", .joint = 1, .parameters = {1.48, 0.05}}};
  d.inputs = {{.path = "<run & \"log\">/ticks.csv", .sha256 = "12ab"}};
  return d;
}

Diagnosis madeUpPostures() {
  Diagnosis d;
  d.verdict = Verdict::kNothingMissing;
  d.before = {.train_rms_Nm = {0.1},
              .heldout_rms_Nm = {},
              .train_relative = {0.02},
              .heldout_relative = {},
              .simulation_rms_rad = {}};
  d.refitted = d.after = d.before;
  d.noise_floor_Nm = {0.1};
  d.curves_rate_Hz = 1.0;
  JointCurves curves;
  Noise noise;
  for (int i = 0; i < 60; ++i) {
    curves.time_s.push_back(i);
    curves.position_rad.push_back(-2.0 + 0.03 * i);
    curves.velocity_rad_s.push_back(0.0);
    curves.acceleration_rad_s2.push_back(0.0);
    curves.torque_Nm.push_back(noise.next());
    curves.residual_before_Nm.push_back(curves.torque_Nm.back());
    curves.residual_after_Nm.push_back(curves.torque_Nm.back());
    curves.heldout.push_back(false);
  }
  d.curves = {curves};
  return d;
}

}  // namespace patella::test
