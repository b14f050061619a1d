// A screening knows columns by their products alone: against the same columns written out.
#include "tools/diagnose/search/screening.hpp"

#include <cmath>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include "tests/unit/diagnose/chain_recordings.hpp"
#include "tests/unit/model/chains.hpp"
#include "tools/diagnose/effects/recipe.hpp"

namespace patella::diagnose {
namespace {

/// Three joints with friction that nobody declared, and atoms of one joint and of several.
class Screened3 {
 public:
  explicit Screened3(bool goes_with_motion)
      : data_(std::array{moved(truth(), 20.0, 0.05)}, DatasetOptions{}),
        fitter_(data_, nominal(), FitOptions{}),
        fit_(fitter_.nominal()),
        atoms_(recipeAtoms(fitter_, recipes(data_, nominal().mechanism,
                                            std::vector<std::string>{"coulomb_friction", "encoder_offset",
                                                                     "tremor", "torque_bias", "payload"},
                                            {}, std::vector<double>(3, 0.05)))),
        screening_(data_, fit_, atoms_, {.replicates = 49, .goes_with_motion = goes_with_motion}) {}

  static model::ModelDescription nominal() {
    return {.mechanism = test::RandomChains(7).draw(3), .effects = {}};
  }
  static model::ModelDescription truth() {
    model::ModelDescription model = nominal();
    model.effects.push_back({.kind = "viscous_friction", .joint = 1, .parameters = {0.4}});
    return model;
  }

  /// The fit's weighted residual, its share taken out, and the rows of the priors below.
  Eigen::VectorXd residual() const {
    const Eigen::VectorXd white = fit_.weighting->apply(fit_.residual);
    Eigen::VectorXd rows(white.size() + fit_.prior_residual.size());
    rows << white, fit_.prior_residual;
    const Eigen::MatrixXd explained = takenUp(fit_, fit_.prior_weight);
    return rows - explained * (explained.transpose() * rows);
  }

  Dataset data_;
  ModelFitter fitter_;
  ModelFit fit_;
  Atoms atoms_;
  Screening screening_;
};

TEST_CASE("bases are orthonormal, span the columns, and know nothing of what the fit explains") {
  const Screened3 all(false);
  const Eigen::MatrixXd explained = takenUp(all.fit_, all.fit_.prior_weight);
  REQUIRE(!all.atoms_.items.empty());
  int several = 0;
  for (std::size_t a = 0; a < all.atoms_.items.size(); a += 7) {
    CAPTURE(all.atoms_.items[a].label);
    several += all.atoms_.onlyJoint(all.atoms_.items[a]) ? 0 : 1;
    const Eigen::MatrixXd basis = all.screening_.basis(a);
    REQUIRE(basis.cols() == all.screening_.groups()[a].count);
    CHECK((basis.transpose() * basis - Eigen::MatrixXd::Identity(basis.cols(), basis.cols())).norm() < 1e-6);
    CHECK((explained.transpose() * basis).norm() < 1e-6);
    const Eigen::MatrixXd weighted = all.fit_.weighting->apply(all.atoms_.of(all.atoms_.items[a]));
    Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(explained.rows(), weighted.cols());
    columns.topRows(weighted.rows()) = weighted;
    const Eigen::MatrixXd left = columns - explained * (explained.transpose() * columns);
    CHECK((left - basis * (basis.transpose() * left)).norm() < 1e-4 * columns.norm());
  }
  CHECK(several > 0);
}

TEST_CASE("gains are those of the columns written out") {
  for (const bool goes_with_motion : {false, true}) {
    CAPTURE(goes_with_motion);
    const Screened3 all(goes_with_motion);
    const Eigen::VectorXd residual = all.residual();
    for (const Screened& screened : all.screening_.results()) {
      if (screened.atom % 5 != 0) {
        continue;
      }
      CAPTURE(all.atoms_.items[screened.atom].label);
      const double gain = (all.screening_.basis(screened.atom).transpose() * residual).squaredNorm();
      CHECK(screened.raw_gain == doctest::Approx(gain).epsilon(1e-6));
    }
  }
}

TEST_CASE("products with rows are those of the bases") {
  const Screened3 all(false);
  Eigen::MatrixXd rows(all.residual().size(), 2);
  for (Eigen::Index i = 0; i < rows.rows(); ++i) {
    rows(i, 0) = std::sin(0.37 * static_cast<double>(i));
    rows(i, 1) = std::cos(1.1 * static_cast<double>(i));
  }
  const Eigen::MatrixXf products = all.screening_.products(rows);
  for (std::size_t a = 0; a < all.atoms_.items.size(); a += 11) {
    CAPTURE(all.atoms_.items[a].label);
    const ScreenedGroup& group = all.screening_.groups()[a];
    const Eigen::MatrixXd direct = all.screening_.basis(a).transpose() * rows;
    CHECK((products.middleRows(group.first, group.count).cast<double>() - direct).norm() <
          1e-3 * rows.norm() / std::sqrt(rows.rows()));
  }
}

// Liang and Zeger's sum, with the columns written out.
double variance(const Eigen::MatrixXd& basis, Eigen::VectorXd residual, Eigen::Index joints) {
  constexpr Eigen::Index kPieces = 40;
  for (Eigen::Index k = 0; k < basis.cols(); ++k) {
    residual -= basis.col(k) * basis.col(k).dot(residual);
  }
  const Eigen::Index rows = residual.size() / joints;
  double sum = 0.0;
  for (Eigen::Index piece = 0; piece < kPieces; ++piece) {
    const Eigen::Index begin = rows * piece / kPieces;
    const Eigen::Index size = rows * (piece + 1) / kPieces - begin;
    Eigen::VectorXd products = Eigen::VectorXd::Zero(basis.cols());
    for (Eigen::Index joint = 0; joint < joints; ++joint) {
      products += basis.middleRows(joint * rows + begin, size).transpose() *
                  residual.segment(joint * rows + begin, size);
    }
    sum += products.squaredNorm();
  }
  const auto columns = static_cast<double>(basis.cols());
  return sum / columns * kPieces / (kPieces - columns);
}

TEST_CASE("what chance brings over time is that of the columns written out") {
  const Screened3 all(true);
  const Eigen::Index rows = all.fit_.weighting->rows() * all.data_.joints();
  const Eigen::VectorXd residual = all.residual().head(rows);
  int compared = 0;
  for (std::size_t a = 0; a < all.atoms_.items.size(); a += 13) {
    CAPTURE(all.atoms_.items[a].label);
    const ScreenedGroup& group = all.screening_.groups()[a];
    if (group.count == 1) {  // of more, the order of the columns counts for a little
      const double direct = variance(all.screening_.basis(a).topRows(rows), residual, all.data_.joints());
      CHECK(group.seen_in_time == doctest::Approx(direct).epsilon(1e-5));
      ++compared;
    }
  }
  CHECK(compared > 0);
}

}  // namespace
}  // namespace patella::diagnose
