// The free numbers of chains: bodies that could be, as many of them as motion can tell.
#include "tools/diagnose/fit/chain_bodies.hpp"

#include <algorithm>
#include <random>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <doctest/doctest.h>

#include "core/model/presets.hpp"
#include "tests/unit/model/chains.hpp"
#include "tools/diagnose/fit/physical_parameters.hpp"

using namespace patella;
using namespace patella::diagnose;

namespace {

std::vector<double> drawn(std::size_t count, double spread, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0.0, spread);
  std::vector<double> z(count);
  for (double& value : z) {
    value = normal(random);
  }
  return z;
}

/// ∫ r rᵀ dm beside mass times centre of mass and mass, about the link's origin.
Eigen::Matrix4d pseudoInertia(const model::ChainLink& link) {
  const auto [xx, yy, zz, xy, xz, yz] = link.inertia_kg_m2;
  Eigen::Matrix3d tensor;
  tensor << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  Eigen::Matrix4d sigma;
  sigma.topLeftCorner<3, 3>() = 0.5 * tensor.trace() * Eigen::Matrix3d::Identity() - tensor +
                                link.mass_kg * link.com_m * link.com_m.transpose();
  sigma.topRightCorner<3, 1>() = link.mass_kg * link.com_m;
  sigma.bottomLeftCorner<1, 3>() = link.mass_kg * link.com_m.transpose();
  sigma(3, 3) = link.mass_kg;
  return sigma;
}

double smallestEigenvalue(const Eigen::Matrix4d& matrix) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix4d>(matrix).eigenvalues()[0];
}

model::SerialChainParameters rods() {
  model::SerialChainParameters chain;
  for (int i = 0; i < 3; ++i) {
    model::ChainLink link;
    link.name = "rod";
    link.origin_m = {i == 0 ? 0.0 : 0.4, 0.0, 0.0};
    link.turn_rad = {i == 1 ? 1.5707963267948966 : 0.0, 0.0, 0.0};
    link.mass_kg = 1.0;
    link.com_m = {0.2, 0.0, 0.0};
    link.inertia_kg_m2 = {0.0, 0.013, 0.013, 0.0, 0.0, 0.0};
    chain.links.push_back(link);
  }
  return chain;
}

Eigen::Index rankOf(const Eigen::MatrixXd& matrix) {
  Eigen::JacobiSVD<Eigen::MatrixXd> decomposition(matrix.rowwise().normalized());
  decomposition.setThreshold(1e-7);
  return decomposition.rank();
}

}  // namespace

TEST_CASE("a link's numbers: its own body at zero, one that could be anywhere else") {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const model::ChainLink link = test::RandomChains(seed).draw(1).links.back();
    const LinkBody body(link);
    const Eigen::Matrix4d nominal = pseudoInertia(link);
    CHECK((pseudoInertia(body.at(LinkBody::Numbers::Zero())) - nominal).norm() < 1e-12 * nominal.norm());
    const std::vector<double> numbers = drawn(LinkBody::kNumbers, 1.0, seed);
    const LinkBody::Numbers x = Eigen::Map<const LinkBody::Numbers>(numbers.data());
    const Eigen::Matrix4d moved = pseudoInertia(body.at(x));
    CHECK((moved - nominal).norm() > 0.05 * nominal.norm());
    CHECK(smallestEigenvalue(moved) > 0.0);
  }
}

TEST_CASE("the mass's number scales all of a link") {
  const model::ChainLink link = test::RandomChains(3).draw(1).links.back();
  LinkBody::Numbers x = LinkBody::Numbers::Zero();
  x[LinkBody::kLogMass] = std::log(1.3);
  const Eigen::Matrix4d expected = 1.3 * pseudoInertia(link);
  CHECK((pseudoInertia(LinkBody(link).at(x)) - expected).norm() < 1e-12 * expected.norm());
}

TEST_CASE("a point mass stays one, and goes along its arm") {
  model::ChainLink link;
  link.mass_kg = 2.0;
  link.com_m = {0.3, 0.0, 0.4};
  const std::vector<double> numbers = drawn(LinkBody::kNumbers, 0.1, 5);
  const model::ChainLink moved = LinkBody(link).at(Eigen::Map<const LinkBody::Numbers>(numbers.data()));
  CHECK(moved.inertia_kg_m2 == std::array<double, 6>{});
  CHECK(moved.com_m.cross(link.com_m).norm() < 1e-9);
  CHECK((moved.com_m - link.com_m).norm() > 1e-3);
  CHECK((moved.com_m - link.com_m).norm() < 0.2);
}

TEST_CASE("a link stays within the bounds of model files") {
  model::ChainLink link;
  link.mass_kg = 900.0;
  link.com_m = {9.0, 0.0, 0.0};
  link.inertia_kg_m2 = {400.0, 600.0, 900.0, 0.0, 0.0, 0.0};
  link.name = "heavy";
  model::SerialChainParameters chain;
  chain.links = {LinkBody(link).at(LinkBody::Numbers::Constant(1.0))};
  CHECK_NOTHROW(model::checked(chain));
}

TEST_CASE("a chain has as many free numbers as base parameters, one fewer where its scale is kept") {
  for (int joints = 1; joints <= kMaxJoints; ++joints) {
    CAPTURE(joints);
    const model::SerialChainParameters parameters =
        test::RandomChains(static_cast<unsigned>(joints)).draw(joints);
    const ChainBodies bodies(parameters, false);
    const model::SerialChain chain(parameters);
    const std::vector<double> zero(bodies.count(), 0.0);
    const model::BaseParameters base = chain.baseParameters();
    CHECK(static_cast<int>(bodies.count()) == chain.baseParameterCount());
    CHECK((bodies.baseParameters(zero) - base).norm() < 1e-12 * base.norm());
    CHECK(rankOf(bodies.baseSlopes(zero)) == chain.baseParameterCount());
    CHECK(bodies.named(zero).size() == bodies.count());

    const ChainBodies scaled(parameters, true);
    CHECK(scaled.count() == std::max<std::size_t>(1, bodies.count() - 1));
  }
}

TEST_CASE("what a chain's numbers stand for is a model that can be read, with the base parameters they say") {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    const model::SerialChainParameters parameters = test::RandomChains(seed).draw(4);
    for (const bool keeps_scale : {false, true}) {
      const ChainBodies bodies(parameters, keeps_scale);
      const std::vector<double> z = drawn(bodies.count(), 0.3, seed);
      const auto moved = std::get<model::SerialChainParameters>(bodies.at(z));
      const model::BaseParameters expected = model::SerialChain(moved).baseParameters();
      CHECK((bodies.baseParameters(z) - expected).norm() < 1e-9 * expected.norm());
    }
  }
}

TEST_CASE("an undriven chain keeps its scale: base parameters that are all smaller are out of reach") {
  const model::SerialChainParameters parameters = test::RandomChains(9).draw(3);
  const ChainBodies bodies(parameters, true);
  const auto length = [&](const std::vector<double>& z) {
    double sum = 0.0;
    for (const NamedParameter& one : bodies.named(z)) {
      sum += std::pow(one.value / one.spread, 2);
    }
    return std::sqrt(sum);
  };
  const double nominal = length(std::vector<double>(bodies.count(), 0.0));
  for (unsigned seed = 1; seed <= 5; ++seed) {
    CHECK(length(drawn(bodies.count(), 0.5, seed)) == doctest::Approx(nominal));
  }
}

TEST_CASE("thin rods stay thin") {
  const ChainBodies bodies(rods(), false);
  CHECK(bodies.count() > 3);
  CHECK(static_cast<int>(bodies.count()) < model::SerialChain(rods()).baseParameterCount());
  const auto moved = std::get<model::SerialChainParameters>(bodies.at(drawn(bodies.count(), 0.3, 1)));
  for (const model::ChainLink& link : moved.links) {
    CHECK(std::abs(link.inertia_kg_m2[0]) < 1e-9);
    CHECK(link.inertia_kg_m2[1] > 0.0);
    CHECK(std::abs(link.com_m.y()) + std::abs(link.com_m.z()) < 1e-9);
  }
  CHECK_NOTHROW(model::SerialChain{moved});
}

TEST_CASE("two legs have the numbers of each, named through") {
  const model::SerialChainParameters leg = test::asChain(model::adultLeg().parameters);
  const ChainBodies both(model::ChainGroupParameters{.chains = {leg, leg}}, false);
  const ChainBodies one(leg, false);
  CHECK(both.count() == 2 * one.count());
  const std::vector<NamedParameter> names = both.named(std::vector<double>(both.count(), 0.0));
  CHECK(names.front().name == "ZZ1_kg_m2");
  CHECK(names.back().name == "MY4_kg_m");
  CHECK(names[one.count()].made_of.starts_with("ZZ3 + "));
}

TEST_CASE("named values have the spread and the slopes that they say") {
  const model::SerialChainParameters chain = test::RandomChains(7).draw(3);
  for (const model::MechanismDescription& mechanism :
       {model::MechanismDescription(chain), model::MechanismDescription(model::adultLeg().parameters)}) {
    const auto parameters = mechanismParameters(mechanism, false);
    const std::vector<double> zero(parameters->count(), 0.0);
    const Eigen::MatrixXd slopes = parameters->namedSlopes(zero);
    const std::vector<NamedParameter> names = parameters->named(zero);
    REQUIRE(static_cast<std::size_t>(slopes.rows()) == names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
      CHECK(names[i].value == doctest::Approx(names[i].nominal));
      CHECK(slopes.row(static_cast<Eigen::Index>(i)).norm() ==
            doctest::Approx(names[i].spread).epsilon(1e-3));
    }
  }
}
