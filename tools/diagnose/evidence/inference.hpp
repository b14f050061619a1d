// Which effects a model lacks, by one score: the evidence of the recordings.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/model_description.hpp"
#include "tools/diagnose/evidence/evidence.hpp"
#include "tools/diagnose/evidence/families.hpp"
#include "tools/diagnose/evidence/moments.hpp"
#include "tools/diagnose/evidence/other.hpp"
#include "tools/diagnose/evidence/verdict.hpp"

namespace patella::diagnose::evidence {

/// A family at a point of its ν, with its columns among the moments.
struct Candidate {
  std::shared_ptr<const Family> family;
  std::vector<double> nu;
  Eigen::Index first = 0;

  Eigen::Index count() const noexcept { return static_cast<Eigen::Index>(family->nonnegative.size()); }
  std::string label() const { return family->label(); }
};

/// Effects beside the nominal model, with what follows.
struct Explanation {
  std::vector<Candidate> effects;
  /// Parameters: mechanism (logarithms of ratios), declared effects (differences of ratios), then each
  /// effect's c.
  Posterior posterior;
  double score = 0.0;    ///< of the evidence, less what the choice among forms costs
  bool possible = true;  ///< no coefficient has a sign that physics forbids
  /// What else could stand in the place of each effect: labels.
  std::vector<std::vector<std::string>> equivalent;
};

class Inference {
 public:
  /// `noise_Nm`: rms of what sensors and declared pushes make of each joint's torque. `data`, and `asked`,
  /// the same recordings with the motion that was asked for, have to outlive it.
  Inference(const Dataset& data, const Dataset& asked, const model::ModelDescription& nominal,
            std::span<const int> channels, double nominal_tolerance, std::vector<double> noise_Nm);

  /// The nominal model within its tolerance.
  const Explanation& plain() const noexcept { return plain_; }
  /// The best explanation that adding, exchanging and dropping effects leads to (threshold::kLeastGain).
  Explanation search();

  /// rms of one joint's torque below the band's edge, N·m.
  struct Left {
    double load_Nm = 0.0;    ///< the largest of drive torque and the rigid body's terms
    double target_Nm = 0.0;  ///< what the nominal model leaves
    double noise_Nm = 0.0;
    double other_Nm = 0.0;  ///< what other functions hold
  };
  std::vector<Left> left(const Explanation& explanation) const;
  /// What an explanation leaves; other functions explain nothing here.
  std::vector<JointRest> rests(const Explanation& explanation) const;
  /// Nats by which the recordings are likelier with other functions beside an explanation than without.
  double structure(const Explanation& explanation) const;
  const Other& other() const noexcept { return other_; }
  /// Index of an effect's first coefficient in the posterior.
  Eigen::Index firstCoefficient(const Explanation& explanation, std::size_t effect) const;
  /// The nominal model with what an explanation adds.
  model::ModelDescription describe(const Explanation& explanation) const;

 private:
  void addMechanism(const Eigen::MatrixXd& regressor, double tolerance);
  void addDeclared(double tolerance);
  void addFixed(const Eigen::VectorXd& column, double sd);
  std::vector<Eigen::VectorXd> noiseFloor(const Eigen::MatrixXd& terms);
  void lookAt(std::vector<Family> families, std::vector<Candidate>& candidates);
  void renew(const Explanation& explanation);

  Explanation explain(std::vector<Candidate> effects, const Levels& start, int rounds) const;
  Explanation refined(Explanation explanation);
  bool moveShapes(const Explanation& explanation, std::vector<Candidate>& moved);
  /// What no noise makes is no new look at the machine in each coefficient.
  void countLooks(const Explanation& explanation);
  Explanation grown(Explanation best);
  Explanation withOneMore(const Explanation& best);
  Explanation withoutNeedless(Explanation best, std::size_t kept) const;
  Explanation exchanged(Explanation best);
  void findEquivalent(Explanation& best);
  std::vector<Candidate> screened(const Explanation& at, std::size_t most) const;
  /// The gain of a candidate from what its columns would add; −∞ where a sign is impossible.
  double gainOf(const Candidate& candidate, Eigen::MatrixXd information,
                const Eigen::VectorXd& product) const;
  std::vector<Parameter> parametersOf(std::span<const Candidate> effects) const;
  double sdOf(const Candidate& candidate, Eigen::Index k) const;
  Eigen::VectorXd residual(const Explanation& explanation) const;

  const Dataset* data_;
  const Dataset* asked_;
  model::ModelDescription nominal_;
  model::DynamicsModel bare_;  ///< the mechanism alone
  Moments moments_;
  Other other_, none_;
  std::vector<Parameter> fixed_;  ///< of mechanism and declared effects
  Eigen::MatrixXd fixed_columns_;
  Eigen::VectorXd target_values_;
  Eigen::Index target_ = 0;
  std::vector<Family> declared_;  ///< each declared effect, beyond its tolerance
  std::vector<double> load_Nm_, noise_Nm_;
  std::vector<Candidate> lasting_;   ///< of motion
  std::vector<Candidate> changing_;  ///< of the drive, and oscillations: they depend on what was found
  std::unique_ptr<Evidence> evidence_, without_other_;
  Explanation plain_;
};

}  // namespace patella::diagnose::evidence
