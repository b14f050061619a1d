// Rules that hold for every kind of the catalogue.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <string>

#include <doctest/doctest.h>

#include "firmware_app/files/model_file.hpp"
#include "tests/support/allocation_counter.hpp"
#include "tests/unit/model/effect_fixture.hpp"
#include "tests/unit/model/random_states.hpp"

using namespace patella;
using namespace patella::model;

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Calls with every kind, mechanism and joint.
template <typename Check>
void forEveryEffect(const Check& check) {
  for (const EffectDescriptor* descriptor : effectCatalogue()) {
    CAPTURE(descriptor->kind);
    for (const char* name : test::kMechanisms) {
      CAPTURE(std::string(name));
      const auto mechanism = test::makeMechanism(name);
      for (int joint = 0; joint < mechanism->joints(); ++joint) {
        CAPTURE(joint);
        check(*descriptor, name, *mechanism, joint);
      }
    }
  }
}

double rms(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) {
    sum += value * value;
  }
  return std::sqrt(sum / static_cast<double>(values.size()));
}

bool isStateful(std::string_view kind) {
  static const std::set<std::string_view> kKinds{"presliding_hysteresis",
                                                 "transmission_elasticity",
                                                 "backlash",
                                                 "actuator_lag",
                                                 "actuator_delay",
                                                 "spasticity",
                                                 "emg_torque"};
  return kKinds.count(kind) > 0;
}

}  // namespace

TEST_CASE("the kinds that say so have an inertia; the others act on their own joint alone") {
  std::set<std::string_view> with_inertia;
  forEveryEffect([&](const EffectDescriptor& descriptor, const char*, const Mechanism& mechanism, int joint) {
    std::vector<double> parameters;
    for (const EffectParameter& parameter : descriptor.parameters) {
      // Away from zero, where even a payload weighs nothing.
      parameters.push_back(parameter.initial != 0.0 ? parameter.initial
                                                    : std::min(0.1, 0.5 * parameter.maximum));
    }
    const auto effect = makeEffect(descriptor.kind, joint, mechanism, parameters);
    for (const auto& state : test::randomStates(mechanism.joints())) {
      if (!effect->inertia(state.q).isZero(0.0)) {
        with_inertia.insert(descriptor.kind);
      }
      EffectInput input;
      input.q = state.q;
      input.dq = state.dq;
      input.torque_Nm = state.ddq;
      effect->reset(input);
      JointVector others = effect->torque(input);
      others[joint] = 0.0;
      CHECK((descriptor.has_inertia || others.isZero(0.0)));
    }
  });
  for (const EffectDescriptor* descriptor : effectCatalogue()) {
    CAPTURE(descriptor->kind);
    CHECK(with_inertia.contains(descriptor->kind) == descriptor->has_inertia);
  }
}

TEST_CASE("the catalogue is complete") {
  std::set<std::string_view> kinds;
  for (const EffectDescriptor* descriptor : effectCatalogue()) {
    kinds.insert(descriptor->kind);
  }
  const std::set<std::string_view> expected{"viscous_friction",
                                            "coulomb_friction",
                                            "asymmetric_friction",
                                            "stribeck_friction",
                                            "load_dependent_friction",
                                            "presliding_hysteresis",
                                            "linear_stiffness",
                                            "passive_knee_moment",
                                            "payload",
                                            "rotor_inertia",
                                            "transmission_elasticity",
                                            "backlash",
                                            "torque_ripple",
                                            "torque_gain",
                                            "torque_bias",
                                            "actuator_lag",
                                            "actuator_delay",
                                            "encoder_offset",
                                            "tremor",
                                            "spasticity",
                                            "emg_torque",
                                            "thermal_drift"};
  CHECK(kinds == expected);
}

TEST_CASE("every parameter is held to its range, and starts inside it") {
  const auto mechanism = test::makeMechanism("leg");
  for (const EffectDescriptor* descriptor : effectCatalogue()) {
    CAPTURE(descriptor->kind);
    for (std::size_t i = 0; i < descriptor->parameters.size(); ++i) {
      const EffectParameter& parameter = descriptor->parameters[i];
      CAPTURE(parameter.name);
      CHECK(parameter.initial >= parameter.minimum);
      CHECK(parameter.initial <= parameter.maximum);
      CHECK_FALSE(parameter.meaning.empty());
      std::vector<double> values = test::initialValues(*descriptor);
      for (const double allowed : {parameter.minimum, parameter.maximum}) {
        values[i] = allowed;
        CHECK_NOTHROW(makeEffect(descriptor->kind, 1, *mechanism, values));
      }
      const double beyond = 1e-6 * (parameter.maximum - parameter.minimum);
      for (const double refused :
           {parameter.minimum - beyond, parameter.maximum + beyond, kNan, kInfinity, -kInfinity}) {
        values[i] = refused;
        CHECK_THROWS_WITH_AS(makeEffect(descriptor->kind, 1, *mechanism, values),
                             doctest::Contains(std::string(parameter.name).c_str()), std::invalid_argument);
      }
    }
  }
}

TEST_CASE("choices that are whole numbers are held to that") {
  const auto mechanism = test::makeMechanism("leg");
  const auto refuses = [&](const char* kind, const std::vector<double>& values, const char* expected) {
    CHECK_THROWS_WITH_AS(makeEffect(kind, 1, *mechanism, values), doctest::Contains(expected),
                         std::invalid_argument);
  };
  refuses("emg_torque", {5.0, 1.5, 0.04}, "effect emg_torque: channel is 1.5, expected a whole number");
  refuses("spasticity", {1.0, 0.5, 0.04, 0.0}, "effect spasticity: direction is 0, expected -1 or 1");
}

TEST_CASE("every kind survives a model file at any allowed values; choices may be left out") {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  const model::MechanismDescription leg = adultLeg().parameters;
  for (const EffectDescriptor* descriptor : effectCatalogue()) {
    CAPTURE(descriptor->kind);
    model::EffectDescription effect{.kind = std::string(descriptor->kind), .joint = 1, .parameters = {}};
    std::string identified;
    for (const EffectParameter& parameter : descriptor->parameters) {
      const double value = parameter.minimum + share(random) * (parameter.maximum - parameter.minimum);
      effect.parameters.push_back(parameter.identified ? value : parameter.maximum);
      if (parameter.identified) {
        identified += std::string(parameter.name) + " = " + std::to_string(parameter.initial) + "\n";
      }
    }
    const std::string text = app::modelText({.mechanism = leg, .effects = {effect}});
    const model::ModelDescription reread = app::parseModel(text, "model.toml");
    REQUIRE(reread.effects.size() == 1);
    CHECK(reread.effects[0].kind == effect.kind);
    CHECK(reread.effects[0].joint == 1);
    CHECK(reread.effects[0].parameters == effect.parameters);
    const model::ModelDescription made = model::describeModel(model::makeModel(reread));
    CHECK(made.effects[0].parameters == effect.parameters);

    const std::string bare = app::modelText({.mechanism = leg, .effects = {}}) + "[[effect]]\nkind = \"" +
                             effect.kind + "\"\njoint = 2\n" + identified;
    const model::ModelDescription defaulted = app::parseModel(bare, "model.toml");
    for (std::size_t i = 0; i < descriptor->parameters.size(); ++i) {
      if (!descriptor->parameters[i].identified) {
        CHECK(defaulted.effects[0].parameters[i] == descriptor->parameters[i].initial);
      }
    }
  }
}

TEST_CASE("along a recording, an effect by itself is what it adds to the loop's model") {
  forEveryEffect(
      [](const EffectDescriptor& descriptor, const char* name, const Mechanism& mechanism, int joint) {
        const std::vector<double> values = test::initialValues(descriptor);
        DynamicsModel with = test::modelWith(name, descriptor.kind, joint, values);
        const DynamicsModel without(test::makeMechanism(name), {});
        const auto alone = makeEffect(descriptor.kind, joint, mechanism, values);
        double largest = 0.0;
        for (const double dt_s : {1e-3, 4e-3}) {
          const std::vector<test::Sample> samples = test::series(mechanism, 1.0, dt_s);
          with.reset(samples.front().input);
          alone->reset(samples.front().input);
          double difference = 0.0;
          for (std::size_t n = 1; n < samples.size(); ++n) {
            const auto& [input, ddq] = samples[n];
            with.advance(input, dt_s);
            const JointVector added = with.inverseDynamics(input, ddq) - without.inverseDynamics(input, ddq);
            alone->advance(input, dt_s);
            const JointVector column = alone->inertia(input.q) * ddq - alone->torque(input);
            difference = std::max(difference, (added - column).cwiseAbs().maxCoeff());
            largest = std::max(largest, column.cwiseAbs().maxCoeff());
          }
          CHECK(difference < 1e-9);
        }
        // Gravity and inertia are the same all along a linear axis.
        if (!(descriptor.kind == "encoder_offset" && std::string_view(name) == "axis")) {
          CHECK(largest > 1e-4);
        }
      });
}

TEST_CASE("the torque is the same just before and just after the memory moves, and asking leaves no trace") {
  forEveryEffect([](const EffectDescriptor& descriptor, const char*, const Mechanism& mechanism, int joint) {
    const std::vector<double> values = test::initialValues(descriptor);
    const auto asked = makeEffect(descriptor.kind, joint, mechanism, values);
    const auto quiet = makeEffect(descriptor.kind, joint, mechanism, values);
    constexpr double kStep_s = 1e-3;
    const std::vector<test::Sample> samples = test::series(mechanism, 0.6, kStep_s);
    for (const bool held : {false, true}) {
      EffectInput input = samples.front().input;
      asked->reset(input);
      quiet->reset(input);
      double jump = 0.0;
      double trace = 0.0;
      for (std::size_t n = 1; n < samples.size(); ++n) {
        asked->torque(test::sampleAt(mechanism, (static_cast<double>(n) - 0.5) * kStep_s).input);
        input = samples[n].input;
        input.torque_held = held;
        const JointVector before = asked->torque(input);
        asked->advance(input, kStep_s);
        const JointVector after = asked->torque(input);
        jump = std::max(jump, (after - before).cwiseAbs().maxCoeff());
        quiet->advance(input, kStep_s);
        trace = std::max(trace, (quiet->torque(input) - after).cwiseAbs().maxCoeff());
      }
      CHECK(jump < 1e-7);
      CHECK(trace == 0.0);
    }
  });
}

TEST_CASE("no effect allocates once it is made") {
  forEveryEffect([](const EffectDescriptor& descriptor, const char*, const Mechanism& mechanism, int joint) {
    const auto effect = makeEffect(descriptor.kind, joint, mechanism, test::initialValues(descriptor));
    const std::vector<test::Sample> samples = test::series(mechanism, 0.05, 1e-3);
    const std::uint64_t before = test::allocationCount();
    double sum = 0.0;
    effect->reset(samples.front().input);
    for (const auto& [input, ddq] : samples) {
      sum += effect->torque(input).sum() + effect->inertia(input.q).sum();
      effect->advance(input, 1e-3);
    }
    CHECK(test::allocationCount() == before);
    CHECK(std::isfinite(sum));
  });
}

TEST_CASE("extreme states, ranges and steps give finite torques, and what is no number is forgotten again") {
  forEveryEffect([](const EffectDescriptor& descriptor, const char*, const Mechanism& mechanism, int joint) {
    const int joints = mechanism.joints();
    std::vector<std::vector<double>> sets{test::initialValues(descriptor), {}, {}};
    for (const EffectParameter& parameter : descriptor.parameters) {
      sets[1].push_back(parameter.minimum);
      sets[2].push_back(parameter.maximum);
    }
    const auto input = [&](double q, double dq, double torque, double time_s) {
      return EffectInput{.q = JointVector::Constant(joints, q),
                         .dq = JointVector::Constant(joints, dq),
                         .torque_Nm = JointVector::Constant(joints, torque),
                         .activation = {1.0, 1.0, 1.0, 1.0},
                         .time_s = time_s};
    };
    for (const std::vector<double>& values : sets) {
      const auto effect = makeEffect(descriptor.kind, joint, mechanism, values);
      effect->reset(input(0.0, 0.0, 0.0, 0.0));
      double time_s = 0.0;
      bool finite = true;
      for (const double size : {1.0, 1e3, 1e6, -1e6, 0.0}) {
        for (const double dt_s : {5e-5, 1e-3, 1e-2, 1.0}) {
          time_s += dt_s;
          const EffectInput extreme = input(size, -size, 0.1 * size, time_s);
          finite = finite && effect->torque(extreme).allFinite();
          effect->advance(extreme, dt_s);
          finite = finite && effect->torque(extreme).allFinite() && effect->inertia(extreme.q).allFinite();
        }
      }
      CHECK(finite);
      effect->advance(input(kNan, kNan, kNan, time_s + 1e-3), 1e-3);
      const EffectInput sound = input(0.1, 0.2, 0.3, time_s + 2e-3);
      effect->advance(sound, 1e-3);
      CHECK(effect->torque(sound).allFinite());
      effect->reset(input(kNan, kNan, kNan, 0.0));
      effect->advance(input(0.1, 0.2, 0.3, 1e-3), 1e-3);
      CHECK(effect->torque(input(0.1, 0.2, 0.3, 1e-3)).allFinite());
    }
  });
}

TEST_CASE("reset seeds the state in which an effect stays while nothing changes") {
  forEveryEffect([](const EffectDescriptor& descriptor, const char*, const Mechanism& mechanism, int joint) {
    const auto effect = makeEffect(descriptor.kind, joint, mechanism, test::initialValues(descriptor));
    EffectInput input = test::sampleAt(mechanism, 0.37).input;
    input.dq.setZero();
    effect->reset(input);
    const JointVector seeded = effect->torque(input);
    for (int n = 0; n < 500; ++n) {
      effect->advance(input, 1e-3);
    }
    CHECK((effect->torque(input) - seeded).cwiseAbs().maxCoeff() < 1e-9);
    for (const char* kind : {"transmission_elasticity", "backlash", "actuator_lag", "actuator_delay"}) {
      if (descriptor.kind == kind) {
        CHECK(seeded.cwiseAbs().maxCoeff() < 1e-9);
      }
    }
  });
}

TEST_CASE("effects with memory hardly depend on the rate at which they are driven") {
  forEveryEffect([](const EffectDescriptor& descriptor, const char*, const Mechanism& mechanism, int joint) {
    if (!isStateful(descriptor.kind)) {
      return;
    }
    const std::vector<double> values = test::initialValues(descriptor);
    constexpr double kGrid_s = 4e-3;
    std::vector<std::vector<double>> columns;
    for (const int substeps : {40, 4, 1}) {
      const double dt_s = kGrid_s / substeps;
      const auto effect = makeEffect(descriptor.kind, joint, mechanism, values);
      std::vector<double> column;
      const std::vector<test::Sample> samples = test::series(mechanism, 3.0, dt_s);
      effect->reset(samples.front().input);
      for (std::size_t n = 1; n < samples.size(); ++n) {
        effect->advance(samples[n].input, dt_s);
        if (n % static_cast<std::size_t>(substeps) == 0) {
          column.push_back(effect->torque(samples[n].input)[joint]);
        }
      }
      columns.push_back(column);
    }
    const double size = rms(columns[0]);
    CHECK(size > 1e-3);
    for (const std::size_t rate : {1U, 2U}) {
      std::vector<double> difference;
      for (std::size_t n = 0; n < columns[0].size(); ++n) {
        difference.push_back(columns[rate][n] - columns[0][n]);
      }
      CAPTURE(rate);
      // Drives behind a spring take steps of up to 0.15/ω; all others follow within 2 %.
      CHECK(rms(difference) < 0.03 * size);
    }
  });
}

TEST_CASE("friction never drives the leg, at any allowed values") {
  const auto mechanism = test::makeMechanism("leg");
  std::mt19937 random(5);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const char* kind : {"viscous_friction", "coulomb_friction", "asymmetric_friction", "stribeck_friction",
                           "load_dependent_friction"}) {
    CAPTURE(kind);
    for (int joint = 0; joint < 2; ++joint) {
      std::vector<double> values;
      for (const EffectParameter& parameter : findEffect(kind)->parameters) {
        values.push_back(parameter.minimum + share(random) * (parameter.maximum - parameter.minimum));
      }
      const auto effect = makeEffect(kind, joint, *mechanism, values);
      bool acts = false;
      for (const auto& [q, dq, ddq] : test::randomStates(2)) {
        for (const double scale : {1.0, 1e-3}) {
          const EffectInput input{.q = q, .dq = scale * dq, .torque_Nm = ddq};
          const double power_W = input.dq.dot(effect->torque(input));
          CHECK(power_W <= 0.0);
          acts = acts || power_W < 0.0;
        }
      }
      CHECK(acts);
    }
  }
}
