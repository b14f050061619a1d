#include "tools/diagnose/fit/chain_bodies.hpp"

#include <algorithm>
#include <cmath>
#include <variant>

#include <Eigen/SVD>

namespace patella::diagnose {
namespace {

constexpr Eigen::Index kPerBody = 10;
/// Of x, for derivatives by differences to both sides: their errors are 1e-10 of the link's parameters.
constexpr double kDifference = 1e-5;
/// What a number moves of a base parameter, as a part of what links of that size have of it, is rounding
/// below this; and so is what a direction moves of them all, each in units of its spread.
constexpr double kRounding = 1e-7;
/// A link's mass is never moved by more than the exponential of this, nor another number by more, whatever
/// the data say.
constexpr double kFarthestLogarithm = 1.5;

/// Standard parameters of a link as seen from a frame in which its own has these axes and origin.
Eigen::Matrix<double, kPerBody, 1> standardOf(const model::ChainLink& link, const Eigen::Matrix3d& axes,
                                              const Eigen::Vector3d& origin) {
  const auto [xx, yy, zz, xy, xz, yz] = link.inertia_kg_m2;
  Eigen::Matrix3d tensor;
  tensor << xx, xy, xz, xy, yy, yz, xz, yz, zz;
  const Eigen::Vector3d com = origin + axes * link.com_m;
  const Eigen::Matrix3d about_origin =
      axes * tensor * axes.transpose() +
      link.mass_kg * (com.squaredNorm() * Eigen::Matrix3d::Identity() - com * com.transpose());
  Eigen::Matrix<double, kPerBody, 1> values;
  values << about_origin(0, 0), about_origin(0, 1), about_origin(0, 2), about_origin(1, 1),
      about_origin(1, 2), about_origin(2, 2), link.mass_kg * com, link.mass_kg;
  return values;
}

/// "ZZ1_kg_m2" of "ZZ1 + 0.0529 M2".
std::string shortName(const std::string& combination) {
  const std::string first = combination.substr(0, combination.find(' '));
  const bool is_mass = first[0] == 'M';
  const bool is_moment = is_mass && std::isdigit(static_cast<unsigned char>(first[1])) == 0;
  return first + (is_moment ? "_kg_m" : is_mass ? "_kg" : "_kg_m2");
}

}  // namespace

ChainBodies::ChainBodies(const model::MechanismDescription& nominal, bool keeps_scale)
    : is_group_(std::holds_alternative<model::ChainGroupParameters>(nominal)), keeps_scale_(keeps_scale) {
  chains_ = is_group_ ? std::get<model::ChainGroupParameters>(nominal).chains
                      : std::vector{std::get<model::SerialChainParameters>(nominal)};
  int joints = 0;
  for (std::size_t number = 0; number < chains_.size(); ++number) {
    const model::SerialChain chain(chains_[number]);
    addLinks(chains_[number], number, kPerBody * joints);
    const Eigen::MatrixXd& own = chain.baseOfStandard();
    const Eigen::Index rows = base_of_standard_.rows(), columns = base_of_standard_.cols();
    Eigen::MatrixXd grown = Eigen::MatrixXd::Zero(rows + own.rows(), columns + own.cols());
    grown.topLeftCorner(rows, columns) = base_of_standard_;
    grown.bottomRightCorner(own.rows(), own.cols()) = own;
    base_of_standard_ = std::move(grown);
    for (std::string& name : chain.baseParameterNames(joints + 1)) {
      combinations_.push_back(std::move(name));
    }
    joints += chain.joints();
  }
  findDirections();
}

void ChainBodies::addLinks(const model::SerialChainParameters& chain, std::size_t number,
                           Eigen::Index first) {
  // Of the present link, in the frame of the link that moves it.
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();
  Eigen::Index standard = first - kPerBody;
  for (std::size_t index = 0; index < chain.links.size(); ++index) {
    const model::ChainLink& link = chain.links[index];
    if (link.joint != model::ChainJoint::kFixed) {
      axes.setIdentity();
      origin.setZero();
      standard += kPerBody;
    } else {
      origin += axes * link.origin_m;
      axes = axes * model::rotationOf(link.turn_rad);
    }
    if (standard >= first && link.mass_kg > 0.0) {
      links_.push_back({.chain = number,
                        .index = index,
                        .body = LinkBody(link),
                        .axes = axes,
                        .origin = origin,
                        .first = standard});
    }
  }
}

model::BaseParameters ChainBodies::freeBase(const Eigen::VectorXd& x) const {
  Eigen::VectorXd standard = Eigen::VectorXd::Zero(base_of_standard_.cols());
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Link& link = links_[i];
    const Eigen::Index own = LinkBody::kNumbers * static_cast<Eigen::Index>(i);
    standard.segment<kPerBody>(link.first) +=
        standardOf(link.body.at(x.segment<LinkBody::kNumbers>(own)), link.axes, link.origin);
  }
  return base_of_standard_ * standard;
}

double ChainBodies::scaleOf(const model::BaseParameters& base) const {
  double own = 0.0;
  for (std::size_t i = 0; i < told_.size(); ++i) {
    own += std::pow(base[told_[i]] / spread_[i], 2);
  }
  return std::sqrt(own);
}

model::BaseParameters ChainBodies::baseOf(const Eigen::VectorXd& x) const {
  const model::BaseParameters base = freeBase(x);
  return keeps_scale_ ? model::BaseParameters(nominal_scale_ / scaleOf(base) * base) : base;
}

Eigen::MatrixXd ChainBodies::slopesOf(
    const std::function<model::BaseParameters(const Eigen::VectorXd& x)>& base) const {
  const Eigen::Index numbers = LinkBody::kNumbers * static_cast<Eigen::Index>(links_.size());
  Eigen::MatrixXd slopes(base_of_standard_.rows(), numbers);
  for (Eigen::Index k = 0; k < numbers; ++k) {
    const Eigen::VectorXd step = kDifference * Eigen::VectorXd::Unit(numbers, k);
    slopes.col(k) = (base(step) - base(-step)) / (2.0 * kDifference);
  }
  return slopes;
}

void ChainBodies::findDirections() {
  const Eigen::MatrixXd free = slopesOf([this](const Eigen::VectorXd& x) { return freeBase(x); });
  // What links of such sizes have of each base parameter.
  Eigen::VectorXd standard = Eigen::VectorXd::Zero(base_of_standard_.cols());
  for (const Link& link : links_) {
    const auto [inertia, moment, mass] = link.body.sizes();
    const double away_m = link.origin.norm();
    auto sizes = standard.segment<kPerBody>(link.first);
    sizes.head<6>().array() += inertia + 2.0 * moment * away_m + mass * away_m * away_m;
    sizes.segment<3>(6).array() += moment + mass * away_m;
    sizes[9] += mass;
  }
  const Eigen::VectorXd sizes = base_of_standard_.cwiseAbs() * standard;
  for (Eigen::Index row = 0; row < free.rows(); ++row) {
    const double spread = free.row(row).norm();
    if (spread > kRounding * sizes[row]) {
      told_.push_back(row);
      spread_.push_back(spread);
    }
  }
  nominal_scale_ = scaleOf(freeBase(Eigen::VectorXd::Zero(free.cols())));
  // In units of their spread: a wrist's inertia is as well told as a shoulder's, a thousand times larger.
  const Eigen::MatrixXd slopes = slopesOf([this](const Eigen::VectorXd& x) { return baseOf(x); });
  const Eigen::MatrixXd scaled =
      Eigen::Map<const Eigen::VectorXd>(spread_.data(), static_cast<Eigen::Index>(spread_.size()))
          .cwiseInverse()
          .asDiagonal() *
      slopes(told_, Eigen::all);
  const Eigen::JacobiSVD<Eigen::MatrixXd> decomposition(scaled, Eigen::ComputeThinV);
  const Eigen::VectorXd& values = decomposition.singularValues();
  // A fit has one number at least: of an undriven joint with one base parameter, one that moves nothing.
  const Eigen::Index rank = std::max<Eigen::Index>(1, (values.array() > kRounding).count());
  directions_ = decomposition.matrixV().leftCols(rank);
}

Eigen::VectorXd ChainBodies::expanded(std::span<const double> z) const {
  return directions_ * Eigen::Map<const Eigen::VectorXd>(z.data(), static_cast<Eigen::Index>(z.size()));
}

model::MechanismDescription ChainBodies::at(std::span<const double> z) const {
  std::vector<model::SerialChainParameters> chains = chains_;
  Eigen::VectorXd numbers = expanded(z);
  if (keeps_scale_) {
    const auto count = static_cast<Eigen::Index>(links_.size());
    numbers(Eigen::seqN(LinkBody::kLogMass, count, LinkBody::kNumbers)).array() +=
        std::log(nominal_scale_ / scaleOf(freeBase(numbers)));
  }
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const Eigen::Index own = LinkBody::kNumbers * static_cast<Eigen::Index>(i);
    chains[links_[i].chain].links[links_[i].index] =
        links_[i].body.at(numbers.segment<LinkBody::kNumbers>(own));
  }
  if (is_group_) {
    return model::ChainGroupParameters{.chains = std::move(chains)};
  }
  return std::move(chains.front());
}

model::BaseParameters ChainBodies::baseParameters(std::span<const double> z) const {
  return baseOf(expanded(z));
}

std::array<double, 2> ChainBodies::range(std::size_t /*index*/) const {
  // All links together may be as much too light as one alone.
  const double largest = kFarthestLogarithm * std::sqrt(static_cast<double>(links_.size()));
  return {-largest, largest};
}

std::vector<NamedParameter> ChainBodies::named(std::span<const double> z) const {
  const model::BaseParameters nominal = baseOf(Eigen::VectorXd::Zero(directions_.rows()));
  const model::BaseParameters values = baseParameters(z);
  std::vector<NamedParameter> all;
  for (std::size_t i = 0; i < told_.size(); ++i) {
    const std::string& combination = combinations_[static_cast<std::size_t>(told_[i])];
    all.push_back({.name = shortName(combination),
                   .made_of = combination,
                   .nominal = nominal[told_[i]],
                   .value = values[told_[i]],
                   .spread = spread_[i]});
  }
  return all;
}

Eigen::MatrixXd ChainBodies::namedSlopes(std::span<const double> z) const {
  return baseSlopes(z)(told_, Eigen::all);
}

}  // namespace patella::diagnose
