// What the search would make of a torque if a recording held it: its deciding step, rehearsed on what a fit
// leaves. Noise is estimated from what is left, as in the search, so that a torque that is slow or constant
// passes for noise in part here, too.
#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/fit/model_fit.hpp"
#include "tools/diagnose/regression/filtered_products.hpp"
#include "tools/diagnose/regression/noise_model.hpp"
#include "tools/diagnose/search/gates.hpp"

namespace patella::diagnose {

/// What an effect has to overcome.
struct Obstacles {
  double chance = 0.0;               ///< gain less the cost of its parameters that chance brings
  std::vector<double> noise_Nm;      ///< of sensors and declared pushes, joint by joint
  std::vector<double> structure_Nm;  ///< what nothing explains beyond that
  std::vector<double> least_Nm;      ///< torque on each joint below which nothing is missed
};

/// Products of the fit's tangent under its weighting, which all rehearsals share.
FilteredProducts productsForRehearsals(const ModelFit& fit);

class Rehearsal {
 public:
  /// `columns` of an effect on `joint`: the first one is its strength, the others come with it. `products`:
  /// as above. The dataset, the fit and the obstacles must outlive it.
  Rehearsal(const Dataset& data, const ModelFit& fit, const FilteredProducts& products,
            const Obstacles& obstacles, const Eigen::MatrixXd& columns, int joint);

  /// Whether the search would assert the effect in four of five recordings that held so many times the part
  /// of the first column that the others do not give.
  bool asserts(double strength) const;

 private:
  /// A linear fit of the parameters of the given fit, and of the effect.
  struct Fitted {
    ModelFit fit;          ///< without a tangent
    Eigen::VectorXd left;  ///< the residual, as a combination of all_
    Eigen::Index parameters() const noexcept { return fit.prior_weight.size(); }
  };
  /// Columns on the joints on which the effect acts are filtered as this torque asks for.
  struct Filter {
    Weighting weighting;
    FilteredProducts products;
  };
  Filter filterFor(const Eigen::VectorXd& torque) const;
  /// `torque`: a combination of all_.
  Fitted fitted(const Eigen::VectorXd& torque, const Weighting& weighting, const FilteredProducts& products,
                bool with_effect) const;
  bool accepts(const Fitted& without, const Fitted& with, const FilteredProducts& products) const;
  double chanceUnit(const ModelFit& with, const Eigen::MatrixXd& gram) const;
  bool outweighsRest(const ModelFit& without, const ModelFit& with) const;
  /// Products of all_ under a weighting, block by block of time; what they say of a fit.
  std::vector<Eigen::MatrixXd> gramsUnder(const Weighting& weighting) const;
  BlockEquations blocksOf(const Fitted& fitted, std::span<const Eigen::MatrixXd> grams) const;

  const Dataset& data_;
  const ModelFit& fit_;
  const Obstacles& obstacles_;
  Eigen::MatrixXd all_;      ///< the fit's tangent, the effect's columns, the fit's residual
  Eigen::Index given_;       ///< columns of the tangent
  Eigen::Index own_;         ///< of the effect
  std::vector<int> joints_;  ///< on which it acts
  Eigen::VectorXd shape_;    ///< the part of its first column that the others do not give, of all_
  FilteredProducts products_;
  Fitted with_;  ///< the effect fitted: nothing of it is in what that leaves
  NoiseProcess noise_;
  double spread_;   ///< standard deviation of the strength
  double against_;  ///< strength that four of five recordings hold against an effect at most
};

}  // namespace patella::diagnose
