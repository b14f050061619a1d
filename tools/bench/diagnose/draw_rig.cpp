#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string_view>

#include "tools/bench/diagnose/cases.hpp"
#include "tools/bench/diagnose/constants.hpp"
#include "tools/bench/diagnose/draw_chain.hpp"
#include "tools/bench/diagnose/random.hpp"

namespace patella::bench {
namespace {

// A machine with its way of moving and the noise that goes with its size.
struct Machine {
  const char* name;
  double share;  ///< of the cases
  Body body;
  PerJoint centre_rad;
  PerJoint amplitude_rad;  ///< peak
  double fastest_Hz;       ///< of a multisine
  Pair human_Nm;           ///< lowest and highest standard deviation
  Pair torque_noise_Nm;
  double encoder_range_rad;
  std::size_t emg_channels;
};

// Paper: Section 5 of the paper; adult: 72 kg, Winter 2009, Table 4.1; arm: a published double pendulum.
const std::array<Machine, 5>& machines() {
  static const std::array<Machine, 5> all{
      Machine{.name = "paper_leg",
              .share = 0.3,
              .body = {.shape = Shape::kLeg,
                       .mass_kg = {2.0, 0.85},
                       .length_m = {0.2, 0.25},
                       .com_m = {0.1, 0.125},
                       .inertia_kg_m2 = {0.02, 0.01328125},
                       .damping_Nms_rad = {0.2, 0.2}},
              .centre_rad = {-1.1, -0.95},
              .amplitude_rad = {0.8, 0.75},
              .fastest_Hz = 2.2,
              .human_Nm = {0.02, 0.10},
              .torque_noise_Nm = {0.01, 0.06},
              .encoder_range_rad = kTurn,
              .emg_channels = 2},
      Machine{.name = "adult_leg",
              .share = 0.3,
              .body = {.shape = Shape::kLeg,
                       .mass_kg = {7.2, 4.392},
                       .length_m = {0.4, 0.4},
                       .com_m = {0.1732, 0.2424},
                       .inertia_kg_m2 = {0.120187008, 0.12160991232},
                       .damping_Nms_rad = {0.5, 0.5}},
              .centre_rad = {-1.0, -0.95},
              .amplitude_rad = {0.7, 0.75},
              .fastest_Hz = 1.6,
              .human_Nm = {0.03, 0.15},
              .torque_noise_Nm = {0.02, 0.1},
              .encoder_range_rad = kTurn,
              .emg_channels = 2},
      Machine{.name = "light_arm",
              .share = 0.15,
              .body = {.shape = Shape::kLeg,
                       .mass_kg = {0.52, 0.63},
                       .length_m = {0.2, 0.3},
                       .com_m = {0.15, 0.22},
                       .inertia_kg_m2 = {0.0109, 0.00997},
                       .damping_Nms_rad = {0.02, 0.02}},
              .centre_rad = {-1.57, 0.0},
              .amplitude_rad = {1.2, 1.2},
              .fastest_Hz = 2.2,
              .human_Nm = {0.02, 0.05},
              .torque_noise_Nm = {0.005, 0.03},
              .encoder_range_rad = kTurn,
              .emg_channels = 0},
      Machine{.name = "knee",
              .share = 0.15,
              .body = {.shape = Shape::kRevolute,
                       .inertia_kg_m2 = {0.35, 0.0},
                       .moment_kg_m = 1.0,
                       .damping_Nms_rad = {0.3, 0.0}},
              .centre_rad = {-0.95, 0.0},
              .amplitude_rad = {0.75, 0.0},
              .fastest_Hz = 1.8,
              .human_Nm = {0.02, 0.15},
              .torque_noise_Nm = {0.02, 0.1},
              .encoder_range_rad = kTurn,
              .emg_channels = 2},
      Machine{.name = "linear_axis",
              .share = 0.1,
              .body = {.shape = Shape::kPrismatic, .mass_kg = {95.0, 0.0}, .damping_Nms_rad = {40.0, 0.0}},
              .centre_rad = {0.0, 0.0},
              .amplitude_rad = {0.25, 0.0},
              .fastest_Hz = 2.0,
              .human_Nm = {2.0, 10.0},
              .torque_noise_Nm = {1.0, 5.0},
              .encoder_range_rad = 1.0,
              .emg_channels = 0},
  };
  return all;
}

const Machine& machineOf(Random& random, std::string& name) {
  if (name.empty()) {
    double left = random.uniform();
    for (const Machine& machine : machines()) {
      left -= machine.share;
      if (left < 0.0) {
        name = machine.name;
        return machine;
      }
    }
    name = machines().back().name;
  }
  for (const Machine& machine : machines()) {
    if (name == machine.name) {
      return machine;
    }
  }
  throw std::invalid_argument(
      "mechanism '" + name +
      "' is unknown, expected paper_leg, adult_leg, light_arm, knee, linear_axis, chain or planar_chain");
}

// Scales the harmonics so that the way stays within the amplitude.
void limit(JointReference& joint, double amplitude_rad, double duration_s) {
  double peak = 0.0;
  for (double time_s = 0.0; time_s < duration_s; time_s += 0.01) {
    double s = 0.0;
    for (const Harmonic& harmonic : joint.harmonics) {
      s += harmonic.amplitude_rad * std::sin(kTurn * harmonic.frequency_Hz * time_s + harmonic.phase_rad);
    }
    peak = std::max(peak, std::abs(s));
  }
  for (Harmonic& harmonic : joint.harmonics) {
    harmonic.amplitude_rad *= amplitude_rad / peak;
  }
}

// Several tones, weaker as they get faster; the first joint sweeps slowly besides.
void multisine(Random& random, const Machine& machine, Rig& rig) {
  for (std::size_t j = 0; j < machine.body.joints(); ++j) {
    JointReference& joint = rig.reference[j];
    if (j == 0) {
      joint.harmonics.push_back({.amplitude_rad = random.uniform(0.8, 1.4),
                                 .frequency_Hz = random.uniform(0.05, 0.1),
                                 .phase_rad = random.uniform(0.0, kTurn)});
    }
    const std::size_t tones = 5 + random.below(3);
    for (std::size_t i = 0; i < tones; ++i) {
      const double frequency_Hz = random.logUniform(0.15, machine.fastest_Hz);
      joint.harmonics.push_back({.amplitude_rad = 1.0 / (1.0 + frequency_Hz),
                                 .frequency_Hz = frequency_Hz,
                                 .phase_rad = random.uniform(0.0, kTurn)});
    }
  }
}

// Harmonics of one period, as walking in a slow robot has it.
void gait(Random& random, const Machine& machine, Rig& rig) {
  const double cadence_Hz = random.uniform(0.4, 0.8);
  constexpr Pair kHip{1.0, 0.15}, kKnee{0.6, 0.5};
  for (std::size_t j = 0; j < machine.body.joints(); ++j) {
    const Pair& share = j == 0 && machine.body.joints() == 2 ? kHip : kKnee;
    for (std::size_t i = 0; i < 2; ++i) {
      rig.reference[j].harmonics.push_back({.amplitude_rad = share[i],
                                            .frequency_Hz = cadence_Hz * static_cast<double>(i + 1),
                                            .phase_rad = random.uniform(0.0, kTurn)});
    }
  }
}

void sine(Random& random, const Machine& machine, Rig& rig) {
  for (std::size_t j = 0; j < machine.body.joints(); ++j) {
    rig.reference[j].harmonics.push_back({.amplitude_rad = 1.0,
                                          .frequency_Hz = random.uniform(0.15, 0.6),
                                          .phase_rad = random.uniform(0.0, kTurn)});
  }
}

void drawMotion(Random& random, const Machine& machine, std::string& motion, Rig& rig) {
  if (motion.empty()) {
    constexpr double kMultisine = 0.6, kGait = 0.2;
    const double lot = random.uniform();
    motion = lot < kMultisine ? "multisine" : lot < kMultisine + kGait ? "gait" : "sine";
  }
  if (motion == "multisine") {
    multisine(random, machine, rig);
  } else if (motion == "gait") {
    gait(random, machine, rig);
  } else if (motion == "sine") {
    sine(random, machine, rig);
  } else {
    throw std::invalid_argument("motion '" + motion + "' is unknown, expected multisine, gait or sine");
  }
  for (std::size_t j = 0; j < machine.body.joints(); ++j) {
    rig.reference[j].centre_rad = machine.centre_rad[j];
    limit(rig.reference[j], machine.amplitude_rad[j] * random.uniform(0.7, 1.0), rig.duration_s);
  }
}

Body wrong(Random& random, const Body& body) {
  Body nominal = body;
  const double error = random.uniform(0.05, 0.10);
  const auto shift = [&](double& value) { value *= 1.0 + random.uniform(-error, error); };
  if (body.shape == Shape::kChain) {
    nominal.chain = wrongChain(random, body.chain, error);
    std::for_each_n(nominal.damping_Nms_rad.begin(), body.joints(), shift);
    return nominal;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    shift(nominal.mass_kg[i]);
    shift(nominal.com_m[i]);
    shift(nominal.inertia_kg_m2[i]);
    shift(nominal.damping_Nms_rad[i]);
  }
  shift(nominal.moment_kg_m);
  return nominal;
}

void drawBus(Random& random, Rig& rig) {
  rig.jitter_s = random.uniform(0.0, 0.3e-3);
  rig.loss_probability = random.chance(0.5) ? random.logUniform(1e-4, 2e-3) : 0.0;
}

constexpr std::string_view kChain = "chain", kPlanarChain = "planar_chain";

// What a chain has in place of a row of the table.
Machine chainMachine(Random& random, const std::string& name, std::size_t joints) {
  Machine machine{.name = name.c_str(),
                  .share = 0.0,
                  .body = drawChain(random, joints, name == kPlanarChain),
                  .centre_rad = {},
                  .amplitude_rad = {},
                  .fastest_Hz = 1.8,
                  .human_Nm = {},
                  .torque_noise_Nm = {},
                  .encoder_range_rad = kTurn,
                  .emg_channels = random.chance(0.5) ? 2U : 0U};
  constexpr double kSlide = 0.25;  // m for rad
  for (std::size_t j = 0; j < joints; ++j) {
    const double part = machine.body.slides(j) ? kSlide : 1.0;
    machine.centre_rad[j] = part * random.uniform(-1.0, 1.0);
    machine.amplitude_rad[j] = part * random.uniform(0.5, 0.9);
  }
  return machine;
}

// Noise in proportion to what each joint carries, as it is with the leg.
void drawChainRig(Random& random, std::string& motion, const std::string& name, std::size_t joints,
                  Rig& rig) {
  constexpr Pair kHuman{0.004, 0.02}, kSensor{0.003, 0.015};
  constexpr int kTries = 1000;
  if (motion.empty()) {
    motion = "multisine";
  }
  PerJoint load_Nm{};
  double encoder_range_rad = 0.0;
  for (int attempt = 0;; ++attempt) {
    if (attempt == kTries) {
      throw std::runtime_error("no chain of " + std::to_string(joints) +
                               " joints has loads of a sensible size");
    }
    const Machine machine = chainMachine(random, name, joints);
    rig.body = machine.body;
    rig.duration_s = random.uniform(20.0, 40.0);
    rig.reference = {};
    drawMotion(random, machine, motion, rig);
    rig.emg_channels = machine.emg_channels;
    encoder_range_rad = machine.encoder_range_rad;
    load_Nm = loadOf(rig);
    if (isSensible(load_Nm, rig.body)) {
      break;
    }
  }
  rig.nominal = wrong(random, rig.body);
  const double bits = static_cast<double>(13 + random.below(5));
  const double torque_noise = random.logUniform(kSensor[0], kSensor[1]);
  for (std::size_t j = 0; j < joints; ++j) {
    rig.encoder_step_rad[j] = encoder_range_rad / std::exp2(bits) * (rig.body.slides(j) ? 0.1 : 1.0);
    rig.torque_noise_Nm[j] = torque_noise * load_Nm[j];
    rig.human_Nm[j] = random.logUniform(kHuman[0], kHuman[1]) * load_Nm[j];
  }
}

void drawMachineRig(Random& random, std::string& mechanism, std::string& motion, Rig& rig) {
  const Machine& machine = machineOf(random, mechanism);
  rig.body = machine.body;
  rig.nominal = wrong(random, machine.body);
  rig.duration_s = random.uniform(20.0, 60.0);
  drawMotion(random, machine, motion, rig);
  const double bits = static_cast<double>(12 + random.below(6));
  rig.encoder_step_rad = everyJoint(machine.encoder_range_rad / std::exp2(bits));
  drawBus(random, rig);
  rig.torque_noise_Nm = everyJoint(random.logUniform(machine.torque_noise_Nm[0], machine.torque_noise_Nm[1]));
  for (std::size_t j = 0; j < machine.body.joints(); ++j) {
    rig.human_Nm[j] = random.logUniform(machine.human_Nm[0], machine.human_Nm[1]);
  }
  rig.emg_channels = machine.emg_channels;
}

}  // namespace

Rig drawRig(std::uint64_t seed, std::string& mechanism, std::string& motion, std::size_t joints) {
  Random random(seed, 100);
  Rig rig;
  rig.seed = seed;
  if (mechanism == kChain || mechanism == kPlanarChain) {
    if (joints == 0) {
      joints = kFewestJoints + random.below(kMostJoints - kFewestJoints + 1);
    }
    drawChainRig(random, motion, mechanism, joints, rig);
    drawBus(random, rig);
  } else {
    drawMachineRig(random, mechanism, motion, rig);
  }
  rig.human_bandwidth_Hz = random.uniform(0.5, 3.0);
  rig.control_bandwidth_Hz = random.uniform(2.5, 4.0);
  return rig;
}

model::ModelDescription nominalModel(const Rig& rig) {
  const Body& body = rig.nominal;
  model::ModelDescription model;
  switch (body.shape) {
    case Shape::kLeg:
      model.mechanism = model::PlanarTwoLinkParameters{.mass_kg = body.mass_kg,
                                                       .length_m = body.length_m,
                                                       .com_m = body.com_m,
                                                       .inertia_kg_m2 = body.inertia_kg_m2,
                                                       .gravity_m_s2 = body.gravity_m_s2};
      break;
    case Shape::kRevolute: {
      constexpr double kShank_m = 0.4;
      model.mechanism = model::RevoluteJointParameters{.inertia_kg_m2 = body.inertia_kg_m2[0],
                                                       .moment_kg_m = body.moment_kg_m,
                                                       .length_m = kShank_m,
                                                       .gravity_m_s2 = body.gravity_m_s2};
      break;
    }
    case Shape::kPrismatic:
      model.mechanism = model::PrismaticJointParameters{.mass_kg = body.mass_kg[0],
                                                        .inclination_rad = body.inclination_rad,
                                                        .gravity_m_s2 = body.gravity_m_s2};
      break;
    case Shape::kChain:
      model.mechanism = body.chain;
      break;
  }
  for (std::size_t j = 0; j < body.joints(); ++j) {
    if (body.damping_Nms_rad[j] > 0.0) {
      model.effects.push_back({.kind = "viscous_friction",
                               .joint = static_cast<int>(j),
                               .parameters = {body.damping_Nms_rad[j]}});
    }
  }
  return model;
}

}  // namespace patella::bench
