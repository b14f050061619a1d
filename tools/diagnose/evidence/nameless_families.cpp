#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "tools/diagnose/evidence/families.hpp"
#include "tools/diagnose/evidence/series_columns.hpp"

namespace patella::diagnose::evidence {
namespace {

double square(double x) {
  return x * x;
}
double cube(double x) {
  return x * x * x;
}
double signedSquare(double x) {
  return x * std::abs(x);
}

Sample of(const Sample& a, double (*f)(double)) {
  return [a, f](std::size_t s, std::size_t i) { return f(a(s, i)); };
}
Sample product(const Sample& a, const Sample& b) {
  return [a, b](std::size_t s, std::size_t i) { return a(s, i) * b(s, i); };
}

/// Shapes of one joint's torque, in variables that lie within about ±1.
class Shapes {
 public:
  Shapes(const Dataset& data, int joint, std::vector<Family>& all) : data_(data), joint_(joint), all_(all) {
    q_ =
        centred([&data, joint](std::size_t s, std::size_t i) { return data.series()[s].states[i].q[joint]; });
    if (!data.isStatic()) {
      dq_ = speed(joint);
      sign_ = of(dq_, [](double x) { return std::tanh(x / kTurningShare); });
      ddq_ = centred(
          [&data, joint](std::size_t s, std::size_t i) { return data.series()[s].acceleration[i][joint]; });
    }
  }

  void ofPosition() {
    constexpr std::array kKnots{-0.5, 0.0, 0.5};
    add(own("q"), "square", {of(q_, square)});
    add(own("q"), "square and cube", {of(q_, square), of(q_, cube)});
    for (const double knot : kKnots) {
      add(own("q"), "bend",
          {[q = q_, knot](std::size_t s, std::size_t i) { return std::max(q(s, i) - knot, 0.0); }},
          kKnots.size());
      add(own("q"), "bend below",
          {[q = q_, knot](std::size_t s, std::size_t i) { return std::max(knot - q(s, i), 0.0); }},
          kKnots.size());
    }
  }

  void ofMotion() {
    constexpr std::array kPlaces{-0.6, -0.2, 0.2, 0.6};
    constexpr double kWidth = 0.25;
    add(own("dq"), "square", {of(dq_, square)});
    add(own("dq"), "signed square", {of(dq_, signedSquare)});
    add(own("dq"), "cube", {of(dq_, cube)});
    const std::string both = own("q") + "*" + own("dq");
    add(both, "product", {product(q_, dq_)});
    add(both, "square of q", {product(of(q_, square), dq_)});
    add(both, "sign", {product(q_, sign_)});
    add(both, "sign and square of q", {sign_, product(of(q_, square), sign_)});
    for (const double place : kPlaces) {
      add(both, "sign at a place",
          {product(sign_,
                   [q = q_, place](std::size_t s, std::size_t i) {
                     return std::exp(-0.5 * square((q(s, i) - place) / kWidth));
                   })},
          kPlaces.size());
    }
    const std::string inertia = own("ddq") + "*" + own("q");
    add(inertia, "product", {product(q_, ddq_)});
    add(inertia, "and square", {product(q_, ddq_), product(of(q_, square), ddq_)});
  }

  void ofOther(int from) {
    const auto name = [=](const char* stem) { return stem + std::to_string(from + 1); };
    const Sample other = centred(
        [&data = data_, from](std::size_t s, std::size_t i) { return data.series()[s].states[i].q[from]; });
    add(name("q"), "line", {other});
    add(name("q"), "line and square", {other, of(other, square)});
    add(own("q") + "*" + name("q"), "product", {product(q_, other)});
    const Sample rate = speed(from);
    add(name("dq"), "line", {rate});
    add(name("dq"), "sign", {of(rate, [](double x) { return std::tanh(x / kTurningShare); })});
    add(own("ddq") + "*" + name("q"), "product", {product(other, ddq_)});
  }

  void ofMuscle(int channel) {
    const std::string name = "activation" + std::to_string(channel);
    const Sample a = [&data = data_, channel](std::size_t s, std::size_t i) {
      return data.series()[s].states[i].activation[static_cast<std::size_t>(channel - 1)];
    };
    add(name, "square", {of(a, square)});
    add(name + "*" + own("q"), "product", {product(a, q_)});
    add(name + "*" + own("q"), "and plain", {a, product(a, q_)});
    add(name + "*" + own("dq"), "product", {product(a, dq_)});
  }

  // A constant, a spring, a damper and dry friction that come and go slowly, or change once.
  void overTime() {
    const auto one = [](std::size_t, std::size_t) { return 1.0; };
    change("time", "constant", one, false);
    change("time*" + own("q"), "spring", q_, true);
    change("time*" + own("dq"), "damper", dq_, true);
    change("time*" + own("dq"), "dry friction", sign_, true);
  }

 private:
  void change(const std::string& variables, const std::string& what, const Sample& carrier, bool with_mean) {
    constexpr double kFastest_Hz = 0.35;
    constexpr int kMostWaves = 24;
    constexpr int kSteps = 5;
    const double first_s = data_.time_s().minCoeff();
    const double duration_s = std::max(data_.time_s().maxCoeff() - first_s, 1.0);
    const auto time_s = [&data = data_, first_s](std::size_t s, std::size_t i) {
      return data.series()[s].states[i].time_s - first_s;
    };
    const double slowest_Hz = 0.5 / duration_s;
    const int waves = std::min(kMostWaves, static_cast<int>(kFastest_Hz / slowest_Hz));
    for (int wave = 1; wave <= waves; ++wave) {
      const double w = 2.0 * std::numbers::pi * slowest_Hz * wave;
      std::vector<Sample> values{
          product(carrier, [time_s, w](std::size_t s, std::size_t i) { return std::sin(w * time_s(s, i)); }),
          product(carrier, [time_s, w](std::size_t s, std::size_t i) { return std::cos(w * time_s(s, i)); })};
      if (with_mean) {
        values.push_back(carrier);
      }
      add(variables, "wave of a " + what, std::move(values), waves);
    }
    for (int step = 1; step <= kSteps; ++step) {
      const double at_s = duration_s * step / (kSteps + 1.0);
      add(variables, "step of a " + what,
          {product(carrier,
                   [time_s, at_s](std::size_t s, std::size_t i) { return time_s(s, i) > at_s ? 1.0 : 0.0; })},
          kSteps);
    }
  }

  std::string own(const char* stem) const { return stem + std::to_string(joint_ + 1); }

  Sample speed(int joint) const {
    return [&data = data_, joint, rms = velocityRms(data_, joint)](std::size_t s, std::size_t i) {
      return data.series()[s].states[i].dq[joint] / rms;
    };
  }

  Sample centred(const Sample& value) const {
    constexpr double kLeast = 1e-9;
    double low = value(0, 0), high = low;
    for (std::size_t s = 0; s < data_.series().size(); ++s) {
      for (std::size_t i = 0; i < data_.series()[s].states.size(); ++i) {
        low = std::min(low, value(s, i));
        high = std::max(high, value(s, i));
      }
    }
    const double middle = 0.5 * (low + high), half = std::max(0.5 * (high - low), kLeast);
    return [value, middle, half](std::size_t s, std::size_t i) { return (value(s, i) - middle) / half; };
  }

  void add(const std::string& variables, const std::string& variant, std::vector<Sample> values,
           double choices = 1.0) {
    const std::size_t count = values.size();
    all_.push_back({.kind = "function of " + variables,
                    .joint = joint_,
                    .variant = variant,
                    .nonnegative = std::vector<bool>(count, false),
                    .choices = choices,
                    .columns = [&data = data_, joint = joint_, values = std::move(values)](
                                   std::span<const double>) { return jointColumns(data, joint, values); },
                    .parameters = [](auto c, auto) { return std::vector<double>(c.begin(), c.end()); },
                    .variables = variables});
  }

  const Dataset& data_;
  int joint_;
  std::vector<Family>& all_;
  Sample q_, dq_, sign_, ddq_;
};

}  // namespace

std::vector<Family> namelessFamilies(const Dataset& data, std::span<const int> channels) {
  std::vector<Family> all;
  for (int joint = 0; joint < data.joints(); ++joint) {
    Shapes shapes(data, joint, all);
    shapes.ofPosition();
    if (data.isStatic()) {
      continue;
    }
    shapes.ofMotion();
    for (int from = 0; from < data.joints(); ++from) {
      if (from != joint) {
        shapes.ofOther(from);
      }
    }
    for (const int channel : channels) {
      shapes.ofMuscle(channel);
    }
    shapes.overTime();
  }
  return all;
}

}  // namespace patella::diagnose::evidence
