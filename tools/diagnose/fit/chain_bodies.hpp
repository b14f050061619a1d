// The free numbers of chains: those of their links' bodies, as far as motion can tell them.
#pragma once

#include <functional>
#include <vector>

#include <Eigen/Core>

#include "tools/diagnose/fit/link_body.hpp"
#include "tools/diagnose/fit/mechanism_parameters.hpp"

namespace patella::diagnose {

/// x has ten numbers for each link with a mass (LinkBody), many of which move alike or not at all. With V the
/// right singular vectors of d(base parameters)/dx at the nominal chains, x = V z: no number without effect,
/// and no more of them than base parameters. A standard normal x, seen through base parameters, is a
/// standard normal z. They are named as base parameters, which are what motion tells.
class ChainBodies final : public MechanismParameters {
 public:
  /// `nominal`: a chain or several.
  ChainBodies(const model::MechanismDescription& nominal, bool keeps_scale);

  std::size_t count() const noexcept override { return static_cast<std::size_t>(directions_.cols()); }
  model::MechanismDescription at(std::span<const double> z) const override;
  model::BaseParameters baseParameters(std::span<const double> z) const override;
  std::array<double, 2> range(std::size_t index) const override;
  /// Without the base parameters that no number moves.
  std::vector<NamedParameter> named(std::span<const double> z) const override;
  Eigen::MatrixXd namedSlopes(std::span<const double> z) const override;

 private:
  struct Link {
    std::size_t chain = 0;
    std::size_t index = 0;  ///< in its chain
    LinkBody body;
    Eigen::Matrix3d axes;    ///< of its frame in that of the link that its joint moves
    Eigen::Vector3d origin;  ///< likewise, m
    Eigen::Index first = 0;  ///< of the standard parameters of what that joint moves
  };

  void addLinks(const model::SerialChainParameters& chain, std::size_t number, Eigen::Index first);
  /// Of ten numbers for each link, one after the other; the scale is free.
  model::BaseParameters freeBase(const Eigen::VectorXd& x) const;
  /// The same with the scale as it is kept.
  model::BaseParameters baseOf(const Eigen::VectorXd& x) const;
  /// Length of the base parameters in units of their spread: larger by a factor where all bodies are.
  double scaleOf(const model::BaseParameters& base) const;
  /// Derivatives at the nominal chains.
  Eigen::MatrixXd slopesOf(const std::function<model::BaseParameters(const Eigen::VectorXd& x)>& base) const;
  Eigen::VectorXd expanded(std::span<const double> z) const;
  void findDirections();

  std::vector<model::SerialChainParameters> chains_;
  bool is_group_;
  bool keeps_scale_;
  std::vector<Link> links_;
  Eigen::MatrixXd base_of_standard_;
  std::vector<std::string> combinations_;  ///< of each base parameter
  Eigen::MatrixXd directions_;             ///< V
  std::vector<Eigen::Index> told_;         ///< base parameters that some number moves
  std::vector<double> spread_;             ///< of these, for a spread of 1 of x
  double nominal_scale_ = 0.0;
};

}  // namespace patella::diagnose
