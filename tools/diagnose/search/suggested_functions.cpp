#include "tools/diagnose/search/suggested_functions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

/// A stiffness that comes and goes does so slower than this, in Hz: slower than a patient moves, or motion
/// and stiffness could not be told apart. Many more than this many frequencies would cost more than they
/// find.
constexpr double kFastestChange_Hz = 0.6;
constexpr int kMostFrequencies = 120;

// Where springs have no torque: in the middle of the motion, or where the fit has found one.
double restPosition(const Dataset& data, const ModelFit& fit, int joint) {
  for (const Term& term : fit.terms) {
    if (term.recipe->kind == "linear_stiffness" && term.recipe->joint == joint) {
      return ModelFitter::effectParameters(term)[1];
    }
  }
  std::vector<double> positions;
  for (const Series& series : data.series()) {
    for (const auto& state : series.states) {
      positions.push_back(state.q[joint]);
    }
  }
  return offline::quantile(positions, 0.5);
}

// Torque in straight proportion to the other joint's position or velocity.
void addCoupling(const Dataset& data, FunctionAtoms& atoms) {
  for (int joint = 0; joint < data.joints(); ++joint) {
    for (int other = 0; other < data.joints(); ++other) {
      if (other == joint) {
        continue;
      }
      const Eigen::VectorXd position =
          data.variable([=](const Series& s, std::size_t i) { return s.states[i].q[other]; });
      const Eigen::VectorXd velocity =
          data.variable([=](const Series& s, std::size_t i) { return s.states[i].dq[other]; });
      atoms.add(fmt::format("q{}", other + 1), joint, std::span(&position, 1));
      atoms.add(fmt::format("dq{}", other + 1), joint, std::span(&velocity, 1));
    }
  }
}

// Frequencies of a spring's stiffness; none where the recording is too short for any.
std::vector<double> slowSwings_Hz(const Dataset& data) {
  const double duration_s = data.time_s().maxCoeff() - data.time_s().minCoeff();
  if (data.isStatic() || duration_s * kFastestChange_Hz < 3.0) {
    return {};
  }
  const double slowest_Hz = 1.5 / duration_s;
  const double step_Hz = std::max(0.6 / duration_s, (kFastestChange_Hz - slowest_Hz) / kMostFrequencies);
  std::vector<double> frequencies;
  for (double frequency_Hz = slowest_Hz; frequency_Hz < kFastestChange_Hz; frequency_Hz += step_Hz) {
    frequencies.push_back(frequency_Hz);
  }
  return frequencies;
}

// Sine and cosine of time, times what `factor` gives.
template <typename Factor>
std::array<Eigen::VectorXd, 2> swings(const Dataset& data, double frequency_Hz, Factor factor) {
  const auto swing = [&](double phase_turns) {
    return data.variable([=](const Series& s, std::size_t i) {
      return factor(s, i) *
             std::sin(2.0 * std::numbers::pi * (frequency_Hz * s.states[i].time_s + phase_turns));
    });
  };
  return {swing(0.0), swing(0.25)};
}

// a (q − rest) of an activation a: a muscle is stiffer the more it is active (Hogan, IEEE Trans. Automatic
// Control 29(8), 1984).
void addMuscleStiffness(const Dataset& data, const ModelFit& fit, std::span<const int> channels,
                        FunctionAtoms& atoms) {
  for (const int channel : channels) {
    for (int joint = 0; joint < data.joints(); ++joint) {
      const double rest = restPosition(data, fit, joint);
      const auto muscle = static_cast<std::size_t>(channel - 1);
      const Eigen::VectorXd column = data.variable([=](const Series& s, std::size_t i) {
        return s.states[i].activation[muscle] * (s.states[i].q[joint] - rest);
      });
      atoms.add(fmt::format("activation{}*q{}", channel, joint + 1), joint, std::span(&column, 1));
    }
  }
}

// d/dt (I(q) dq) − ½ I′ dq² of I(q) = Δ and Δ², with Δ from restPosition(); the constant is a rotor's.
void addChangingInertia(const Dataset& data, const ModelFit& fit, FunctionAtoms& atoms) {
  for (int joint = 0; joint < data.joints() && !data.isStatic(); ++joint) {
    const double middle = restPosition(data, fit, joint);
    const auto torque = [=](const Series& s, std::size_t i, bool square) {
      const double away = s.states[i].q[joint] - middle;
      const double inertia = square ? away * away : away;
      const double slope = square ? 2.0 * away : 1.0;
      return inertia * s.asked_acceleration[i][joint] + 0.5 * slope * std::pow(s.states[i].dq[joint], 2);
    };
    const std::array<Eigen::VectorXd, 2> powers = {
        data.variable([=](const Series& s, std::size_t i) { return torque(s, i, false); }),
        data.variable([=](const Series& s, std::size_t i) { return torque(s, i, true); })};
    atoms.add(fmt::format("ddq{}*q{}", joint + 1, joint + 1), joint, powers);
  }
}

// Drag of the second and third power of speed.
void addDrag(const Dataset& data, FunctionAtoms& atoms) {
  for (int joint = 0; joint < data.joints() && !data.isStatic(); ++joint) {
    const auto power = [&](double exponent) {
      return data.variable([=](const Series& s, std::size_t i) {
        return std::copysign(std::pow(std::abs(s.states[i].dq[joint]), exponent), s.states[i].dq[joint]);
      });
    };
    const std::array<Eigen::VectorXd, 2> powers = {power(2.0), power(3.0)};
    atoms.add(fmt::format("dq{}", joint + 1), joint, powers);
  }
}

// A stop or a strap that the joint reaches now and then, beyond a position which it seldom passes: knots lie
// too far apart to show it.
void addStops(const Dataset& data, FunctionAtoms& atoms) {
  constexpr std::array kBeyond{0.1, 0.03, 0.01, 0.003};
  for (int joint = 0; joint < data.joints() && !data.isStatic(); ++joint) {
    std::vector<double> positions;
    for (const Series& series : data.series()) {
      for (const auto& state : series.states) {
        positions.push_back(state.q[joint]);
      }
    }
    for (const double share : kBeyond) {
      for (const double side : {-1.0, 1.0}) {
        const double from = offline::quantile(positions, side > 0.0 ? 1.0 - share : share);
        const Eigen::VectorXd pressed = data.variable([=](const Series& s, std::size_t i) {
          return std::max(0.0, side * (s.states[i].q[joint] - from));
        });
        atoms.add(fmt::format("q{}", joint + 1), joint, std::span(&pressed, 1));
      }
    }
  }
}

/// A stretch of a recording, as shares of its rows.
struct Stretch {
  double from = 0.0;
  double to = 1.0;
};

// From some row on, in small steps: a change that lasts. And between two rows, in larger ones: one that
// passes. A stretch at the beginning is the end of a change that lasts the other way round.
std::vector<Stretch> stretches() {
  constexpr int kChanges = 24, kPassing = 8;
  std::vector<Stretch> all;
  for (int from = 1; from < kChanges; ++from) {
    all.push_back({.from = static_cast<double>(from) / kChanges});
  }
  for (int from = 1; from < kPassing; ++from) {
    for (int to = from + 1; to < kPassing; ++to) {
      all.push_back({static_cast<double>(from) / kPassing, static_cast<double>(to) / kPassing});
    }
  }
  return all;
}

// A load that is taken up or put down, a drive whose gain changes: the modelled torque in a stretch of the
// recording, or more and more. Parameters that are constant take up no more than its mean.
void addChangingLoad(const Dataset& data, const ModelFit& fit, FunctionAtoms& atoms) {
  const Eigen::Index rows = data.rows();
  const Eigen::VectorXd driven = data.driveTorque();
  for (int joint = 0; joint < data.joints() && !data.isStatic(); ++joint) {
    const auto left = fit.residual.segment(joint * rows, rows);
    const auto drive = driven.segment(joint * rows, rows);
    // What the model has on a joint that nothing drives is what is left, by its definition.
    if (drive.norm() < 2.0 * left.norm()) {
      continue;
    }
    const Eigen::VectorXd modelled = drive - left;
    const std::string label = fmt::format("torque{}*time", joint + 1);
    for (const Stretch& stretch : stretches()) {
      const auto first = static_cast<Eigen::Index>(stretch.from * static_cast<double>(rows));
      const Eigen::Index count = static_cast<Eigen::Index>(stretch.to * static_cast<double>(rows)) - first;
      Eigen::VectorXd changed = Eigen::VectorXd::Zero(rows);
      changed.segment(first, count) = modelled.segment(first, count);
      atoms.add(label, joint, std::span(&changed, 1));
    }
    const Eigen::VectorXd growing = modelled.cwiseProduct(Eigen::VectorXd::LinSpaced(rows, 0.0, 1.0));
    atoms.add(label, joint, std::span(&growing, 1));
  }
}

}  // namespace

void FunctionAtoms::add(const std::string& label, int joint, std::span<const Eigen::VectorXd> functions) {
  items_.push_back({.recipe = nullptr,
                    .nu = {},
                    .label = label,
                    .joint = joint,
                    .first = static_cast<Eigen::Index>(columns_.size()),
                    .count = static_cast<Eigen::Index>(functions.size())});
  for (const Eigen::VectorXd& function : functions) {
    columns_.emplace_back(Eigen::VectorXd::Zero(data_->rows() * data_->joints()));
    columns_.back().segment(joint * data_->rows(), data_->rows()) = function;
  }
}

Atoms FunctionAtoms::finished() && {
  Atoms atoms{.items = std::move(items_), .columns = {}, .data = data_};
  atoms.columns.resize(data_->rows() * data_->joints(), static_cast<Eigen::Index>(columns_.size()));
  for (std::size_t k = 0; k < columns_.size(); ++k) {
    atoms.columns.col(static_cast<Eigen::Index>(k)) = columns_[k];
  }
  return atoms;
}

void addSuggested(const Dataset& data, const ModelFit& fit, std::span<const int> channels,
                  FunctionAtoms& atoms) {
  addCoupling(data, atoms);
  addMuscleStiffness(data, fit, channels, atoms);
  addChangingInertia(data, fit, atoms);
  addDrag(data, atoms);
  addStops(data, atoms);
  if (!fit.namesAny()) {
    addChangingLoad(data, fit, atoms);
  }
}

// k(t) (q − rest) where k swings: about the rest of restPosition(); and about any, which takes a swing by
// itself beside one that goes with the position.
Atoms changingStiffness(const Dataset& data, const ModelFit& fit) {
  FunctionAtoms atoms(data);
  for (int joint = 0; joint < data.joints(); ++joint) {
    const std::string label = fmt::format("q{}*time", joint + 1);
    const double rest = restPosition(data, fit, joint);
    const bool has_mean = std::any_of(fit.terms.begin(), fit.terms.end(), [joint](const Term& term) {
      return !term.declared && term.recipe->joint == joint && isOfPosition(term.recipe->kind);
    });
    for (const double frequency_Hz : slowSwings_Hz(data)) {
      const auto position = swings(
          data, frequency_Hz, [=](const Series& s, std::size_t i) { return s.states[i].q[joint] - rest; });
      atoms.add(label, joint, position);
      if (has_mean) {
        const auto alone = swings(data, frequency_Hz, [](const Series&, std::size_t) { return 1.0; });
        atoms.add(label, joint, std::array{position[0], position[1], alone[0], alone[1]});
      }
    }
  }
  return std::move(atoms).finished();
}

}  // namespace patella::diagnose
