#include "tools/diagnose/plan/best_states.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Dense>

namespace patella::diagnose {
namespace {

constexpr int kFirstStates = 200;  ///< for each joint
constexpr int kExchanges = 40;
constexpr double kNear = 1.02;       ///< bound over what is attained, at which exchanging ends
constexpr int kDraws = 1500;         ///< for each joint and exchange
constexpr int kLastLooks = 10;       ///< for the farthest state, once the exchange has ended
constexpr int kClimbs = 6;           ///< of the best of them
constexpr double kFirstStep = 0.25;  ///< of a climb, of each range
constexpr double kLastStep = 1e-3;
constexpr int kReweighings = 300;
constexpr double kLeastWeight = 1e-7;
constexpr double kRidge = 1e-9;  ///< of a column's own information

class Search {
 public:
  Search(MotionColumns& columns, Eigen::Index main, std::span<const Eigen::Index> beside,
         std::span<const double> noise_Nm, double samples, const MotionLimits& limits)
      : columns_(columns),
        main_(main),
        beside_(beside.begin(), beside.end()),
        prior_(columns.prior()(beside_)),
        noise_Nm_(noise_Nm.begin(), noise_Nm.end()),
        samples_(samples),
        limits_(limits),
        joints_(static_cast<Eigen::Index>(limits.size())) {}

  BestStates run() {
    for (Eigen::Index i = 0; i < kFirstStates * joints_; ++i) {
      add(drawn());
    }
    BestStates best{.attained = 0.0, .bound = INFINITY};
    Eigen::VectorXd nearest;
    for (int exchange = 0; exchange < kExchanges && best.bound > kNear * best.attained; ++exchange) {
      best.attained = weigh();
      if (!(best.attained > 0.0)) {
        return {};
      }
      const std::vector<Point> climbed = farthest();
      if (const double bound = known() + farness(climbed.front()); bound < best.bound) {
        best.bound = bound;
        nearest = v_;
      }
      for (const Point& point : climbed) {
        add(point);
      }
    }
    // The smallest of many bounds is one whose farthest state was perhaps not found.
    v_ = nearest;
    for (int look = 0; look < kLastLooks; ++look) {
      best.bound = std::max(best.bound, known() + farness(farthest().front()));
    }
    return best;
  }

 private:
  /// q, q̇ and τ of each joint, as shares of their ranges from −1 to 1.
  using Point = Eigen::VectorXd;
  /// The effect's column, then the others, in units of noise.
  struct State {
    Eigen::VectorXd s;
    Eigen::MatrixXd n;
    double weight = 0.0;
  };

  Point drawn() {
    Point point(3 * joints_);
    std::uniform_real_distribution<double> anywhere(-1.0, 1.0);
    std::uniform_int_distribution<int> lot(0, 3);
    for (Eigen::Index k = 0; k < point.size(); ++k) {
      // The ends of a range tell most.
      const int where = lot(random_);
      point[k] = where == 0 ? -1.0 : where == 1 ? 1.0 : anywhere(random_);
    }
    return point;
  }

  State at(const Point& point) {
    JointVector q(joints_), dq(joints_), torque_Nm(joints_);
    for (Eigen::Index j = 0; j < joints_; ++j) {
      const UsableRange& limit = limits_[static_cast<std::size_t>(j)];
      q[j] = 0.5 * (limit.lowest_rad + limit.highest_rad) +
             0.5 * (limit.highest_rad - limit.lowest_rad) * point[j];
      dq[j] = limit.speed_rad_s * point[joints_ + j];
      torque_Nm[j] = limit.torque_Nm * point[2 * joints_ + j];
    }
    const Eigen::MatrixXd rows =
        columns_.at(q, dq, columns_.torque().acceleration(q, dq, torque_Nm), 0.0, 0.0);
    State state{.s = rows.col(main_), .n = rows(Eigen::all, beside_)};
    for (Eigen::Index j = 0; j < joints_; ++j) {
      state.s[j] /= noise_Nm_[static_cast<std::size_t>(j)];
      state.n.row(j) /= noise_Nm_[static_cast<std::size_t>(j)];
    }
    return state;
  }
  void add(const Point& point) {
    states_.push_back(at(point));
    states_.back().weight = 1.0 / static_cast<double>(states_.size());
    // The others make room.
    for (std::size_t i = 0; i + 1 < states_.size(); ++i) {
      states_[i].weight *= 1.0 - states_.back().weight;
    }
  }

  double known() const { return v_.dot(prior_.cwiseProduct(v_)); }
  double farness(const State& state) const { return samples_ * (state.s - state.n * v_).squaredNorm(); }
  double farness(const Point& point) { return farness(at(point)); }

  // Weights of the states at hand that tell most, and what they tell; leaves v of them.
  double weigh() {
    double information = 0.0;
    for (int step = 0; step < kReweighings; ++step) {
      solve();
      double mean = 0.0;
      std::vector<double> far(states_.size());
      for (std::size_t i = 0; i < states_.size(); ++i) {
        far[i] = farness(states_[i]);
        mean += states_[i].weight * far[i];
      }
      information = mean + known();
      // Weights go with the square root of the directional derivative: a fixed point is the best design.
      double sum = 0.0;
      for (std::size_t i = 0; i < states_.size(); ++i) {
        states_[i].weight *= std::sqrt(far[i] / std::max(mean, 1e-300));
        sum += states_[i].weight;
      }
      if (!(sum > 0.0)) {
        return 0.0;
      }
      for (State& state : states_) {
        state.weight /= sum;
      }
    }
    std::erase_if(states_, [](const State& state) { return state.weight < kLeastWeight; });
    return information;
  }

  void solve() {
    const auto others = static_cast<Eigen::Index>(beside_.size());
    Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(others, others);
    Eigen::VectorXd across = Eigen::VectorXd::Zero(others);
    for (const State& state : states_) {
      gram.noalias() += samples_ * state.weight * state.n.transpose() * state.n;
      across.noalias() += samples_ * state.weight * state.n.transpose() * state.s;
    }
    gram.diagonal() += prior_;
    const Eigen::VectorXd length = gram.diagonal().cwiseSqrt().cwiseMax(1e-150);
    gram = length.cwiseInverse().asDiagonal() * gram * length.cwiseInverse().asDiagonal();
    gram.diagonal().array() += kRidge;
    v_ = length.cwiseInverse().asDiagonal() *
         gram.ldlt().solve(length.cwiseInverse().asDiagonal() * across).eval();
  }

  // States that tell most beyond v, the farthest first.
  std::vector<Point> farthest() {
    std::vector<std::pair<double, Point>> best;
    for (Eigen::Index i = 0; i < kDraws * joints_; ++i) {
      Point point = drawn();
      const double far = farness(point);
      if (best.size() < kClimbs || far > best.back().first) {
        best.emplace_back(far, std::move(point));
        std::sort(best.begin(), best.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
        best.resize(std::min<std::size_t>(best.size(), kClimbs));
      }
    }
    std::vector<Point> points;
    for (auto& [far, point] : best) {
      climb(far, point);
    }
    std::sort(best.begin(), best.end(), [](const auto& a, const auto& b) { return a.first > b.first; });
    for (auto& [far, point] : best) {
      points.push_back(std::move(point));
    }
    return points;
  }

  void climb(double& far, Point& point) {
    for (double step = kFirstStep; step > kLastStep;) {
      bool better = false;
      for (Eigen::Index k = 0; k < point.size(); ++k) {
        for (const double way : {step, -step}) {
          Point other = point;
          other[k] = std::clamp(other[k] + way, -1.0, 1.0);
          if (const double there = farness(other); there > far) {
            far = there;
            point = std::move(other);
            better = true;
          }
        }
      }
      step = better ? step : 0.5 * step;
    }
  }

  MotionColumns& columns_;
  Eigen::Index main_;
  std::vector<Eigen::Index> beside_;
  Eigen::VectorXd prior_;
  std::vector<double> noise_Nm_;
  double samples_;
  const MotionLimits& limits_;
  Eigen::Index joints_;
  std::mt19937_64 random_{1};
  std::vector<State> states_;
  Eigen::VectorXd v_;
};

}  // namespace

BestStates bestStates(MotionColumns& columns, Eigen::Index main, std::span<const Eigen::Index> beside,
                      std::span<const double> noise_Nm, double samples, const MotionLimits& limits) {
  return Search(columns, main, beside, noise_Nm, samples, limits).run();
}

}  // namespace patella::diagnose
