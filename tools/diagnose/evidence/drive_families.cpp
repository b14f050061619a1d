#include <algorithm>
#include <cmath>

#include "tools/diagnose/effects/recipe_parts.hpp"
#include "tools/diagnose/evidence/drive_kinds.hpp"
#include "tools/diagnose/evidence/families.hpp"
#include "tools/diagnose/evidence/series_columns.hpp"

namespace patella::diagnose::evidence {
namespace {

// Standard deviations of what drives have.
constexpr double kUsualGain = 0.1;
/// Largest share of the torque that a drive may take away: nearly all.
constexpr double kMostGain = 0.9;
constexpr double kUsual_s = 0.01;
// Over which a torque is differentiated, against periods of 70 ms and more in the band.
constexpr double kSlope_s = 2e-3;
constexpr double kBend_s = 4e-3;

/// One drive; τ is the torque of its link.
class Drive {
 public:
  Drive(const Dataset& data, std::shared_ptr<const LinkTorque> link, int joint)
      : data_(&data),
        link_(std::move(link)),
        joint_(joint),
        turning_rad_s_(kTurningShare * velocityRms(data, joint)) {
    double sum = 0.0, count = 0.0;
    for (const auto& series : *link_) {
      for (const JointVector& value : series) {
        sum += value[joint] * value[joint];
        count += 1.0;
      }
    }
    torque_rms_Nm_ = std::sqrt(sum / count);
  }

  // u = τ − b
  Family bias() const {
    return family("torque_bias", {false}, 0.0, {[](std::size_t, std::size_t) { return -1.0; }},
                  [](auto c, auto) { return std::vector<double>{c[0]}; });
  }

  // u = τ / (1 + g) = τ − c τ
  Family gain() const {
    return family("torque_gain", {false}, kUsualGain,
                  {[*this](std::size_t s, std::size_t i) { return -at(s, i, 0.0); }},
                  [](auto c, auto) { return std::vector<double>{c[0] / (1.0 - std::min(c[0], kMostGain))}; });
  }

  // u = τ + μ |τ| sign q̇: |τ| is what the gear transmits
  Family loadFriction() const {
    return family(
        "load_dependent_friction", {true}, 0.0, {[*this](std::size_t s, std::size_t i) {
          return std::abs(at(s, i, 0.0)) *
                 std::tanh(data_->series()[s].states[i].dq[joint_] / turning_rad_s_);
        }},
        [smoothing = turning_rad_s_](auto c, auto) -> std::vector<double> {
          return Parameters("load_dependent_friction").set("coefficient", c[0]).set(kSmoothing, smoothing);
        });
  }

  // u = τ + T dτ/dt
  Family lag() const {
    return family("actuator_lag", {true}, kUsual_s, {[*this](std::size_t s, std::size_t i) {
                    return (at(s, i, kSlope_s) - at(s, i, -kSlope_s)) / (2.0 * kSlope_s);
                  }},
                  [](auto c, auto) -> std::vector<double> {
                    return Parameters("actuator_lag").set("time_constant_s", c[0]);
                  });
  }

  // u = τ(t + d): the coefficient is the delay, ν where the slope is taken
  Family delay() const {
    Family result = family("actuator_delay", {true}, kUsual_s, {}, [](auto c, auto) -> std::vector<double> {
      return Parameters("actuator_delay").set("delay_s", c[0]);
    });
    result.grid = {{0.004}, {0.012}, {0.03}};
    result.columns = [*this](std::span<const double> nu) {
      return jointColumns(*data_, joint_, {[this, delay_s = nu[0]](std::size_t s, std::size_t i) {
        return (at(s, i, delay_s) - at(s, i, 0.0)) / delay_s;
      }});
    };
    return result;
  }

  // u = τ + J (q̈ + τ̈ / k)
  Family elasticity() const {
    Family result = family(
        "transmission_elasticity", {true, true}, 0.0,
        {acceleration(), bend([*this](std::size_t s, std::size_t i, double t) { return at(s, i, t); })},
        [](auto c, auto) -> std::vector<double> {
          Parameters parameters("transmission_elasticity");
          const double stiffest = parameters.of("stiffness_Nm_rad").maximum;
          return parameters.set("stiffness_Nm_rad", c[1] > 0.0 ? c[0] / c[1] : stiffest)
              .set("rotor_inertia_kg_m2", c[0]);
        });
    result.contains = {"rotor_inertia"};
    return result;
  }

  // u = τ + J (q̈ + ½ gap d²/dt² sign τ): the motor is at one flank or at the other, as the torque goes
  Family backlash() const {
    const double crossing_Nm = 0.02 * torque_rms_Nm_;
    Family result =
        family("backlash", {true, true}, 0.0,
               {acceleration(), bend([*this, crossing_Nm](std::size_t s, std::size_t i, double t) {
                  return std::tanh(at(s, i, t) / crossing_Nm);
                })},
               [](auto c, auto) -> std::vector<double> {
                 return Parameters("backlash")
                     .set("rotor_inertia_kg_m2", c[0])
                     .set("gap_rad", c[0] > 0.0 ? 2.0 * c[1] / c[0] : 0.0);
               });
    result.contains = {"rotor_inertia"};
    return result;
  }

 private:
  Family family(const char* kind, std::vector<bool> nonnegative, double sd, std::vector<Sample> samples,
                decltype(Family::parameters) parameters) const {
    return {.kind = kind,
            .joint = joint_,
            .nonnegative = std::move(nonnegative),
            .sd = sd,
            .columns = [data = data_, joint = joint_, samples = std::move(samples)](
                           std::span<const double>) { return jointColumns(*data, joint, samples); },
            .parameters = std::move(parameters)};
  }

  // τ so much later than the sample.
  double at(std::size_t s, std::size_t i, double later_s) const {
    const auto& values = (*link_)[s];
    const auto last = static_cast<double>(values.size() - 1);
    const double place = std::clamp(static_cast<double>(i) + later_s * data_->series()[s].rate_Hz, 0.0, last);
    const auto low = std::min(static_cast<std::size_t>(place), values.size() - 2);
    const double part = place - static_cast<double>(low);
    return (1.0 - part) * values[low][joint_] + part * values[low + 1][joint_];
  }

  Sample acceleration() const {
    return [data = data_, joint = joint_](std::size_t s, std::size_t i) {
      return data->series()[s].acceleration[i][joint];
    };
  }

  static Sample bend(std::function<double(std::size_t, std::size_t, double)> value) {
    return [value = std::move(value)](std::size_t s, std::size_t i) {
      return (value(s, i, kBend_s) - 2.0 * value(s, i, 0.0) + value(s, i, -kBend_s)) / (kBend_s * kBend_s);
    };
  }

  const Dataset* data_;
  std::shared_ptr<const LinkTorque> link_;
  int joint_;
  double turning_rad_s_;
  double torque_rms_Nm_ = 0.0;
};

}  // namespace

LinkTorque linkTorque(const Dataset& data, const model::ModelDescription& model) {
  model::ModelDescription link = model;
  std::erase_if(link.effects, [](const model::EffectDescription& effect) { return isOfDrive(effect.kind); });
  model::DynamicsModel dynamics = model::makeModel(link);
  LinkTorque torque;
  for (const Series& series : data.series()) {
    torque.emplace_back();
    dynamics.reset(series.states.front());
    for (std::size_t i = 0; i < series.states.size(); ++i) {
      if (i > 0) {
        dynamics.advance(series.states[i], 1.0 / series.rate_Hz);
      }
      torque.back().push_back(dynamics.inverseDynamics(series.states[i], series.acceleration[i]));
    }
  }
  return torque;
}

std::vector<Family> driveFamilies(const Dataset& data, const std::shared_ptr<const LinkTorque>& link) {
  std::vector<Family> all;
  for (int joint = 0; joint < data.joints(); ++joint) {
    const Drive drive(data, link, joint);
    all.push_back(drive.bias());
    if (!data.isStatic()) {
      all.insert(all.end(), {drive.gain(), drive.loadFriction(), drive.lag(), drive.delay(),
                             drive.elasticity(), drive.backlash()});
    }
  }
  return all;
}

}  // namespace patella::diagnose::evidence
