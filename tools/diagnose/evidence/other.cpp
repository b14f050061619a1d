#include "tools/diagnose/evidence/other.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <fmt/format.h>

namespace patella::diagnose::evidence {
namespace {

using Function = std::function<double(const Series&, std::size_t)>;

// A variable mapped so that its usual range is 0 … 1.
struct Scaled {
  Function value;
  double low = 0.0;
  double range = 1.0;
  double operator()(const Series& series, std::size_t i) const {
    return std::clamp((value(series, i) - low) / range, -0.25, 1.25);
  }
};

Scaled scaled(const Dataset& data, Function value) {
  constexpr double kTail = 0.01;
  std::vector<double> all;
  for (const Series& series : data.series()) {
    for (std::size_t i = 0; i < series.states.size(); i += 5) {
      all.push_back(value(series, i));
    }
  }
  const auto at = [&](double share) {
    auto place = all.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(all.size() - 1));
    std::nth_element(all.begin(), place, all.end());
    return *place;
  };
  const double low = at(kTail), high = at(1.0 - kTail);
  return {.value = std::move(value), .low = low, .range = std::max(high - low, 1e-9)};
}

// Cosine of m half waves over the range: m = 0 is the constant, 1 nearly linear.
double cosine(double x, int m) {
  return std::cos(std::numbers::pi * m * x);
}

// Prior variance of the m-th: that of a function with a curvature of its own size (Matérn 1/2, length half
// the range).
double spread(int m) {
  const double w = 0.5 * std::numbers::pi * m;
  return 1.0 / (1.0 + w * w);
}

class Builder {
 public:
  Builder(const Dataset& data, std::span<const int> channels, const Eigen::MatrixXd& known)
      : data_(data), channels_(channels) {
    for (int joint = 0; joint < data.joints(); ++joint) {
      Eigen::MatrixXd own(data.rows(), known.cols() + 5);
      Eigen::Index used = 0;
      const auto take = [&](Eigen::VectorXd values) {
        for (int pass = 0; pass < 2; ++pass) {
          values -= own.leftCols(used) * (own.leftCols(used).transpose() * values);
        }
        const double size = values.norm();
        if (size > 1e-9) {
          own.col(used++) = values / size;
        }
      };
      const auto scaledTo1 = [](Eigen::VectorXd values) {
        const double size = values.norm();
        return size > 0.0 ? Eigen::VectorXd(values / size) : values;
      };
      take(Eigen::VectorXd::Ones(data.rows()));
      for (Eigen::Index k = 0; k < known.cols(); ++k) {
        take(scaledTo1(known.col(k).segment(joint * data.rows(), data.rows())));
      }
      const double rms = velocityRms(joint);
      take(scaledTo1(data.variable([=](const Series& s, std::size_t i) { return s.states[i].q[joint]; })));
      take(scaledTo1(data.variable([=](const Series& s, std::size_t i) { return s.states[i].dq[joint]; })));
      take(
          scaledTo1(data.variable([=](const Series& s, std::size_t i) { return s.acceleration[i][joint]; })));
      take(scaledTo1(data.variable(
          [=](const Series& s, std::size_t i) { return std::tanh(s.states[i].dq[joint] / (0.01 * rms)); })));
      known_.emplace_back(own.leftCols(used));
    }
  }

  Other build() {
    for (int joint = 0; joint < data_.joints(); ++joint) {
      if (data_.isStatic()) {
        resting(joint);
      } else {
        moving(joint);
      }
    }
    other_.columns.conservativeResize(data_.rows() * data_.joints(), used_);
    return std::move(other_);
  }

 private:
  void resting(int joint) {
    const Scaled q = scaled(data_, [=](const Series& s, std::size_t i) { return s.states[i].q[joint]; });
    open(joint, fmt::format("q{}", joint + 1));
    for (int m = 1; m <= 6; ++m) {
      add([=](const Series& s, std::size_t i) { return cosine(q(s, i), m); }, spread(m));
    }
    const Scaled time = scaled(data_, [](const Series& s, std::size_t i) { return s.states[i].time_s; });
    open(joint, "time");
    for (int m = 1; m <= 8; ++m) {
      add([=](const Series& s, std::size_t i) { return cosine(time(s, i), m); }, spread(m));
    }
  }

  void moving(int joint) {
    const int number = joint + 1;
    const Scaled q = scaled(data_, [=](const Series& s, std::size_t i) { return s.states[i].q[joint]; });
    const Scaled dq = scaled(data_, [=](const Series& s, std::size_t i) { return s.states[i].dq[joint]; });
    const Scaled ddq =
        scaled(data_, [=](const Series& s, std::size_t i) { return s.acceleration[i][joint]; });
    const Scaled time = scaled(data_, [](const Series& s, std::size_t i) { return s.states[i].time_s; });
    const double rms = velocityRms(joint);
    const auto sign = [=](const Series& s, std::size_t i) {
      return std::tanh(s.states[i].dq[joint] / (0.02 * rms));
    };
    const auto speed = [=](const Series& s, std::size_t i) { return s.states[i].dq[joint] / rms; };
    open(joint, fmt::format("q{}", number));
    for (int m = 1; m <= 6; ++m) {
      add([=](const Series& s, std::size_t i) { return cosine(q(s, i), m); }, spread(m));
    }
    open(joint, fmt::format("dq{}", number));
    for (int m = 1; m <= 6; ++m) {
      add([=](const Series& s, std::size_t i) { return cosine(dq(s, i), m); }, spread(m));
    }
    open(joint, fmt::format("sign(dq{})*q{}", number, number));
    for (int m = 0; m <= 4; ++m) {
      add([=](const Series& s, std::size_t i) { return sign(s, i) * cosine(q(s, i), m); }, spread(m));
    }
    open(joint, fmt::format("sign(dq{})*dq{}", number, number));
    for (const double width : {0.05, 0.15, 0.4, 1.0}) {
      add([=](const Series& s,
              std::size_t i) { return sign(s, i) * std::exp(-std::abs(speed(s, i)) / width); },
          1.0);
    }
    open(joint, fmt::format("q{}*dq{}", number, number));
    for (int m = 1; m <= 3; ++m) {
      for (int n = 1; n <= 3; ++n) {
        add([=](const Series& s, std::size_t i) { return cosine(q(s, i), m) * cosine(dq(s, i), n); },
            spread(m) * spread(n));
      }
    }
    open(joint, fmt::format("ddq{}*q{}", number, number));
    for (int m = 0; m <= 3; ++m) {
      add([=](const Series& s, std::size_t i) { return ddq.value(s, i) / ddq.range * cosine(q(s, i), m); },
          spread(m));
    }
    open(joint, "time");
    for (int m = 1; m <= 8; ++m) {
      add([=](const Series& s, std::size_t i) { return cosine(time(s, i), m); }, spread(m));
    }
    open(joint, fmt::format("time*sign(dq{})", number));
    for (int m = 1; m <= 6; ++m) {
      add([=](const Series& s, std::size_t i) { return cosine(time(s, i), m) * sign(s, i); }, spread(m));
    }
    open(joint, fmt::format("time*dq{}", number));
    for (int m = 1; m <= 4; ++m) {
      add([=](const Series& s, std::size_t i) { return cosine(time(s, i), m) * speed(s, i); }, spread(m));
    }
    open(joint, fmt::format("time*q{}", number));
    for (int m = 1; m <= 4; ++m) {
      add([=](const Series& s, std::size_t i) { return cosine(time(s, i), m) * cosine(q(s, i), 1); },
          spread(m));
    }
    for (int from = 0; from < data_.joints(); ++from) {
      if (from != joint) {
        across(joint, from, q);
      }
    }
    for (const int channel : channels_) {
      muscle(joint, channel, q);
    }
  }

  void across(int joint, int from, const Scaled& q) {
    const Scaled q_from = scaled(data_, [=](const Series& s, std::size_t i) { return s.states[i].q[from]; });
    const Scaled dq_from =
        scaled(data_, [=](const Series& s, std::size_t i) { return s.states[i].dq[from]; });
    const Scaled ddq_from =
        scaled(data_, [=](const Series& s, std::size_t i) { return s.acceleration[i][from]; });
    open(joint, fmt::format("q{}", from + 1));
    for (int m = 1; m <= 4; ++m) {
      add([=](const Series& s, std::size_t i) { return cosine(q_from(s, i), m); }, spread(m));
    }
    open(joint, fmt::format("dq{}", from + 1));
    for (int m = 1; m <= 4; ++m) {
      add([=](const Series& s, std::size_t i) { return cosine(dq_from(s, i), m); }, spread(m));
    }
    open(joint, fmt::format("q{}*q{}", joint + 1, from + 1));
    for (int m = 1; m <= 3; ++m) {
      for (int n = 1; n <= 3; ++n) {
        add([=](const Series& s, std::size_t i) { return cosine(q(s, i), m) * cosine(q_from(s, i), n); },
            spread(m) * spread(n));
      }
    }
    open(joint, fmt::format("ddq{}*q{}", from + 1, from + 1));
    for (int m = 0; m <= 2; ++m) {
      add([=](const Series& s,
              std::size_t i) { return ddq_from.value(s, i) / ddq_from.range * cosine(q_from(s, i), m); },
          spread(m));
    }
  }

  void muscle(int joint, int channel, const Scaled& q) {
    const auto activation = [=](const Series& s, std::size_t i) {
      return s.states[i].activation[static_cast<std::size_t>(channel - 1)];
    };
    open(joint, fmt::format("activation{}", channel));
    for (int m = 0; m <= 2; ++m) {
      add([=](const Series& s, std::size_t i) { return activation(s, i) * cosine(q(s, i), m); }, spread(m));
    }
  }

  double velocityRms(int joint) const {
    double sum = 0.0, count = 0.0;
    for (const Series& series : data_.series()) {
      for (const model::EffectInput& state : series.states) {
        sum += state.dq[joint] * state.dq[joint];
      }
      count += static_cast<double>(series.states.size());
    }
    return std::max(std::sqrt(sum / count), 1e-9);
  }

  void open(int joint, std::string variables) {
    other_.groups.push_back(
        {.joint = joint, .variables = std::move(variables), .first = used_, .spread = {}});
  }

  void add(const Function& function, double prior) {
    Eigen::VectorXd values = data_.variable(function);
    const double whole = values.norm();
    const Eigen::MatrixXd& known = known_[static_cast<std::size_t>(other_.groups.back().joint)];
    values -= known * (known.transpose() * values);
    const double rms = std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
    if (values.norm() < 1e-3 * whole || whole == 0.0) {
      return;
    }
    append(values / rms, prior);
  }

  void append(const Eigen::VectorXd& values, double prior) {
    if (used_ == other_.columns.cols()) {
      other_.columns.conservativeResize(data_.rows() * data_.joints(), 2 * used_ + 16);
    }
    OtherGroup& group = other_.groups.back();
    other_.columns.col(used_).setZero();
    other_.columns.col(used_).segment(group.joint * data_.rows(), data_.rows()) = values;
    ++used_;
    group.spread.push_back(prior);
  }

  const Dataset& data_;
  std::span<const int> channels_;
  std::vector<Eigen::MatrixXd> known_;  ///< orthonormal, of each joint
  Other other_;
  Eigen::Index used_ = 0;
};

}  // namespace

Other otherFunctions(const Dataset& data, std::span<const int> channels, const Eigen::MatrixXd& known) {
  return Builder(data, channels, known).build();
}

}  // namespace patella::diagnose::evidence
