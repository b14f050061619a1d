// What a model may lack, as columns: effects of the library on each joint, and shapes that have no name.
#pragma once

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/regression/dataset.hpp"

namespace patella::diagnose::evidence {

struct ShapeRange {
  double lower = 0.0;
  double upper = 0.0;
};

/// A form of an effect on a joint:  torque that it takes = Σ c_k column_k(ν).
struct Family {
  std::string kind;
  int joint = 0;                              ///< from 0; −1: of all
  std::string variant{};                      ///< tells forms of one kind apart; mostly empty
  std::vector<bool> nonnegative;              ///< of each coefficient c
  std::vector<ShapeRange> shape{};            ///< of each ν
  std::vector<std::vector<double>> grid{{}};  ///< points ν at which a search looks
  double choices = 1.0;                       ///< points ν that a recording could tell apart
  double sd = 0.0;  ///< of a coefficient beforehand; 0: such that the effect takes a share of the load
  /// Kinds on the joint whose torque is a special case of this one: it takes their place.
  std::vector<std::string> contains{};
  /// At a point ν, as Columns.
  std::function<Eigen::MatrixXd(std::span<const double> nu)> columns;
  /// Parameters of the effect, in the order in which model files name them.
  std::function<std::vector<double>(std::span<const double> c, std::span<const double> nu)> parameters;
  /// What the torque of a shape without a name depends on: "dq1", "time"; empty for an effect of the library.
  std::string variables{};

  std::string label() const { return kind + "@" + std::to_string(joint + 1); }
  bool isNamed() const noexcept { return variables.empty() && joint >= 0; }
};

/// Torque that a model needs on the link side for the recorded motion, before the band: of each series, each
/// sample, each joint. Effects of the drive are left out.
using LinkTorque = std::vector<std::vector<JointVector>>;
LinkTorque linkTorque(const Dataset& data, const model::ModelDescription& model);

/// In all of these `data` has to outlive the families.
/// Effects of motion, EMG and time alone, and the rigid body's own base parameters beyond their tolerance.
std::vector<Family> motionFamilies(const Dataset& data, const model::ModelDescription& nominal,
                                   std::span<const int> channels);
/// Effects between the drive's torque and the link's. The torque is predicted from the motion: what the drive
/// has to give follows from the link's torque by the inverse of what the drive does to it, so that no effect
/// can copy the recorded torque.
std::vector<Family> driveFamilies(const Dataset& data, const std::shared_ptr<const LinkTorque>& link);
/// Lines in what is left of a joint's torque, over time and over position; `left`: as a Column.
std::vector<Family> oscillatingFamilies(const Dataset& data, const Eigen::VectorXd& left);
/// Shapes without a name: low powers and products of the joints' states and of EMG, slow changes over time.
/// What one of them explains better than every effect is missing, but not known.
std::vector<Family> namelessFamilies(const Dataset& data, std::span<const int> channels);

}  // namespace patella::diagnose::evidence
