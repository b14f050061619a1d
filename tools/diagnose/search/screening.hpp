// Looks for the columns that would explain most of what a fit leaves, and says how much chance alone would
// explain.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "tools/diagnose/search/search.hpp"

namespace patella::diagnose {

/// The gain of an atom beyond the fit.
struct Screened {
  std::size_t atom = 0;
  double raw_gain = 0.0;    ///< fall of the weighted squared error
  double gain = 0.0;        ///< the same in units of what chance brings a column on average
  bool wrong_sign = false;  ///< the gain would take a sign that physics does not allow
  int dimensions = 0;       ///< columns that the fit does not span already, and nonlinear parameters
  Eigen::VectorXd c;        ///< coefficients of the columns
};

/// A screening has to draw some chance; so little where nobody looks at it.
inline constexpr int kFewestReplicates = 2;

struct ScreeningOptions {
  int replicates = 499;
  std::uint64_t seed = 1;
  Eigen::MatrixXd nuisance{};  ///< Columns that may take up what they can, like the fitted parameters
  /// Chance brings a column at least what its products with the residual vary over time: the encoder's noise
  /// is in both, a push moves the joints, and draws know nothing of that.
  bool goes_with_motion = false;
};

/// How chance treats an atom.
struct ScreenedGroup {
  Eigen::Index first = 0;  ///< row among the products
  Eigen::Index count = 0;
  int dimensions = 0;
  bool one_sided = false;
  double unit = 1.0;          ///< mean square that chance brings a column
  double seen_in_time = 0.0;  ///< the same from the recording itself; see ScreeningOptions
};

/// Mean square that chance brings a column of a recording's own residual, where it brings draws `unit`.
double withMotion(const ScreenedGroup& group, double unit);

/// Tests atoms on what a fit leaves. What counts as much is not a sum of squares but how it compares with the
/// same sum in residuals drawn from the fit's noise: drawn, filtered and projected like the recording itself.
/// Most columns act on one of up to eight joints. So no column is brought to all of the weighted rows: with W
/// the weighting's filter f and then its root, and E an orthonormal basis of what the fit explains,
///   (W a)·r = (f a)·(rootᵀ r), on the rows of the joints of a,   |W a − E Eᵀ W a|² = |W a|² − |Eᵀ W a|².
class Screening {
 public:
  /// The atoms must outlive it.
  Screening(const Dataset& data, const ModelFit& fit, const Atoms& atoms, const ScreeningOptions& options);

  const std::vector<Screened>& results() const noexcept { return results_; }

  using Statistic = std::function<double(double gain, int dimensions)>;
  /// Largest statistic over all atoms in data that the fit explains but for its noise; nominal parameters
  /// drawn from their tolerance. One value a replicate.
  std::vector<double> chance(const Statistic& statistic) const;

  /// One for each atom.
  const std::vector<ScreenedGroup>& groups() const noexcept { return groups_; }
  /// E: weighted rows, the priors' rows below.
  const Eigen::MatrixXd& explained() const noexcept { return explained_; }
  /// Combinations of an atom's columns that are orthonormal once weighted and without the fit's share.
  const Eigen::MatrixXd& combinations(std::size_t atom) const { return orthonormal_[atom]; }
  /// Orthonormal columns of an atom: weighted rows, the fit's share taken out, and the priors' rows below.
  Eigen::MatrixXd basis(std::size_t atom) const;
  /// Products of all atoms' bases with columns like those.
  Eigen::MatrixXf products(const Eigen::MatrixXd& rows) const;

 private:
  /// Rows of one joint, or of all.
  struct Span {
    Eigen::Index first = 0;
    Eigen::Index joints = 1;
  };
  /// Atoms on the same joints, some of them at a time.
  struct Batch {
    Span span;
    std::vector<std::size_t> atoms;
    std::vector<Eigen::Index> first;  ///< column of each atom
    Eigen::MatrixXf columns;          ///< filtered
    Eigen::MatrixXd explained;        ///< their products with E
  };
  /// What is left for the atoms. Pieces of time are one, or as many as the variance over time needs.
  struct Left {
    Eigen::MatrixXd basis;     ///< rootᵀ E
    Eigen::VectorXd residual;  ///< rootᵀ r, r the weighted residual without the fit's share
    Eigen::MatrixXd precision;
    std::vector<Eigen::MatrixXd> gram;    ///< EᵀE of each piece
    std::vector<Eigen::VectorXd> moment;  ///< Eᵀr
    Eigen::Index rows = 0;                ///< of one joint
    /// First row of a piece and their number, on one joint.
    std::pair<Eigen::Index, Eigen::Index> rowsOf(std::size_t piece) const noexcept;
  };
  /// Columns of a batch, on the rows of its joints.
  struct Weighed {
    Eigen::MatrixXd own;                     ///< filtered
    Eigen::MatrixXd dual;                    ///< times the joints' precision: own·dual is weighted·weighted
    std::vector<Eigen::MatrixXd> explained;  ///< EᵀW a of each piece
    std::vector<Eigen::MatrixXd> taken;      ///< EᵀE of each piece times the whole EᵀW a
  };
  struct Products;

  Left leftOf(const ModelFit& fit, std::size_t pieces) const;
  std::vector<Batch> batches() const;
  Weighed weigh(Batch& batch, const Left& left) const;
  Products productsOf(const Batch& batch, std::size_t atom, const Weighed& weighed, const Left& left) const;
  void screen(std::size_t index, const Products& products, bool in_time);
  void drawChance(const Dataset& data, const ModelFit& fit, const ScreeningOptions& options);

  const Atoms& atoms_;
  Eigen::Index joints_;
  std::shared_ptr<const Weighting> weighting_;
  Eigen::MatrixXd explained_;
  std::vector<Batch> batches_;
  std::vector<Eigen::MatrixXd> orthonormal_;  ///< combinations() of each atom
  Eigen::MatrixXf products_;                  ///< of the basis with the draws
  std::vector<ScreenedGroup> groups_;
  std::vector<Screened> results_;
};

}  // namespace patella::diagnose
