#include "tools/diagnose/verdict/dependence.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <tuple>

#include <boost/math/distributions/chi_squared.hpp>
#include <fmt/format.h>

#include "tools/diagnose/search/second_look.hpp"
#include "tools/diagnose/search/suggested_functions.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

constexpr int kKnots = 8;

using Value = std::function<double(const Series&, std::size_t)>;

struct Variable {
  std::string name;
  Value value;
  Value factor;  ///< multiplies every function of the value; empty: 1
};

std::vector<Variable> variables(const Dataset& data, std::span<const int> channels) {
  std::vector<Variable> all;
  const auto state = [&](const char* stem, auto member) {
    for (int j = 0; j < data.joints(); ++j) {
      all.push_back({.name = fmt::format("{}{}", stem, j + 1),
                     .value = [=](const Series& s, std::size_t i) { return member(s, i)[j]; },
                     .factor = {}});
    }
  };
  state("q", [](const Series& s, std::size_t i) { return s.states[i].q; });
  if (data.isStatic()) {
    // A variable that changed from posture to posture and is not in the recording.
    all.push_back({.name = "order",
                   .value = [](const Series& s, std::size_t i) { return s.states[i].time_s; },
                   .factor = {}});
    return all;
  }
  state("dq", [](const Series& s, std::size_t i) { return s.states[i].dq; });
  state("ddq", [](const Series& s, std::size_t i) { return s.asked_acceleration[i]; });
  all.push_back({.name = "time",
                 .value = [](const Series& s, std::size_t i) { return s.states[i].time_s; },
                 .factor = {}});
  for (const int channel : channels) {
    all.push_back({.name = fmt::format("activation{}", channel),
                   .value =
                       [=](const Series& s, std::size_t i) {
                         return s.states[i].activation[static_cast<std::size_t>(channel - 1)];
                       },
                   .factor = {}});
  }
  for (const int channel : channels) {
    const auto activation = static_cast<std::size_t>(channel - 1);
    for (int j = 0; j < data.joints(); ++j) {
      all.push_back(
          {.name = fmt::format("activation{}*q{}", channel, j + 1),
           .value = [=](const Series& s, std::size_t i) { return s.states[i].q[j]; },
           .factor = [=](const Series& s, std::size_t i) { return s.states[i].activation[activation]; }});
    }
  }
  for (int j = 0; j < data.joints(); ++j) {
    const Value acceleration = [=](const Series& s, std::size_t i) { return s.asked_acceleration[i][j]; };
    const Value velocity = [=](const Series& s, std::size_t i) { return s.states[i].dq[j]; };
    const Value position = [=](const Series& s, std::size_t i) { return s.states[i].q[j]; };
    const Value time = [](const Series& s, std::size_t i) { return s.states[i].time_s; };
    all.push_back(
        {.name = fmt::format("ddq{}*q{}", j + 1, j + 1), .value = position, .factor = acceleration});
    all.push_back({.name = fmt::format("dq{}*q{}", j + 1, j + 1), .value = position, .factor = velocity});
    const Value direction = [=](const Series& s, std::size_t i) {
      return s.states[i].dq[j] > 0.0 ? 1.0 : s.states[i].dq[j] < 0.0 ? -1.0 : 0.0;
    };
    all.push_back({.name = fmt::format("dq{}*q{}", j + 1, j + 1), .value = position, .factor = direction});
    all.push_back({.name = fmt::format("q{}*time", j + 1), .value = time, .factor = position});
    all.push_back({.name = fmt::format("dq{}*time", j + 1), .value = time, .factor = velocity});
  }
  return all;
}

// Knots with equal numbers of samples between them.
std::vector<double> knots(const Dataset& data, const Value& value) {
  std::vector<double> samples;
  for (const Series& series : data.series()) {
    for (std::size_t i = 0; i < series.states.size(); ++i) {
      samples.push_back(value(series, i));
    }
  }
  std::vector<double> places;
  for (int k = 0; k < kKnots; ++k) {
    const double place = offline::quantile(samples, static_cast<double>(k) / (kKnots - 1));
    if (places.empty() || place > places.back() + 1e-9) {
      places.push_back(place);
    }
  }
  return places;
}

// 1 at a knot, 0 at its neighbours.
double hat(const std::vector<double>& knots, std::size_t k, double x) {
  if (k > 0 && x < knots[k]) {
    return std::max(0.0, (x - knots[k - 1]) / (knots[k] - knots[k - 1]));
  }
  if (k + 1 < knots.size() && x > knots[k]) {
    return std::max(0.0, (knots[k + 1] - x) / (knots[k + 1] - knots[k]));
  }
  return 1.0;
}

Atoms functionAtoms(const Dataset& data, const ModelFit& fit, std::span<const int> channels) {
  FunctionAtoms atoms(data);
  for (const Variable& variable : variables(data, channels)) {
    const std::vector<double> places = knots(data, variable.value);
    if (places.size() < 3) {
      continue;
    }
    std::vector<Eigen::VectorXd> functions;
    for (std::size_t k = 0; k < places.size(); ++k) {
      functions.push_back(data.variable([&](const Series& s, std::size_t i) {
        return hat(places, k, variable.value(s, i)) * (variable.factor ? variable.factor(s, i) : 1.0);
      }));
    }
    for (int joint = 0; joint < data.joints(); ++joint) {
      atoms.add(variable.name, joint, functions);
    }
  }
  addSuggested(data, fit, channels, atoms);
  return std::move(atoms).finished();
}

// Free terms beside the fitted parameters: a constant on every joint, whose name is known
// where there is one; and slow accelerations. A person's push moves the leg, so a residual always goes with
// them to some degree; and that is straight proportion, which the inertias mostly take up.
Eigen::MatrixXd nuisance(const Dataset& data) {
  const int joints = data.joints();
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(data.rows() * joints, joints * (joints + 1));
  for (int on = 0; on < joints; ++on) {
    const auto put = [&](int column, const std::function<double(const Series&, std::size_t)>& value) {
      columns.col(on * (joints + 1) + column).segment(on * data.rows(), data.rows()) = data.variable(value);
    };
    for (int of = 0; of < joints; ++of) {
      put(of, [=](const Series& s, std::size_t i) { return s.asked_acceleration[i][of]; });
    }
    put(joints, [](const Series&, std::size_t) { return 1.0; });
  }
  return columns;
}

// Larger for what is less likely by chance.
double surprise(double gain, int dimensions) {
  if (dimensions == 0 || !(gain > 0.0)) {
    return 0.0;
  }
  if (!std::isfinite(gain)) {
    // A fit that leaves nothing: chance would have brought nothing either.
    return gain;
  }
  // Beyond this the tail has no digits left; the gain still orders.
  constexpr double kLeast = 1e-280;
  // In double precision: enough for an order, and a third of the time.
  using Plain = boost::math::policies::policy<boost::math::policies::promote_double<false>>;
  const boost::math::chi_squared_distribution<double, Plain> chance(dimensions);
  const double tail = boost::math::cdf(boost::math::complement(chance, gain));
  return tail > kLeast ? -std::log(tail) : -std::log(kLeast) + gain;
}

class Tester {
 public:
  Tester(const Dataset& data, const ModelFit& fit, std::span<const double> least_Nm, int replicates,
         std::uint64_t seed)
      : data_(data),
        fit_(fit),
        least_Nm_(least_Nm),
        nuisance_(nuisance(data)),
        replicates_(replicates),
        seed_(seed) {}

  /// Adds what a family of functions shows that chance would in so many recordings.
  void test(const Atoms& atoms, double family_wise_p) {
    if (atoms.items.empty()) {
      return;
    }
    const Screening screening(
        data_, fit_, atoms,
        {.replicates = replicates_, .seed = seed_, .nuisance = nuisance_, .goes_with_motion = true});
    const std::vector<double> chance = screening.chance(surprise);
    double least_p = 1.0;  // of what a second look is for
    for (const Screened& screened : screening.results()) {
      const double p_value = exceedance(chance, surprise(screened.gain, screened.dimensions));
      if (screened.c.size() <= kColumnsOfSecondLook) {
        least_p = std::min(least_p, p_value);
      }
      if (p_value < family_wise_p) {
        add(atoms.items[screened.atom], screened, p_value);
      }
    }
    if (ranked_.empty() && least_p < unknown::kWorthASecondLook) {
      const SecondLook again =
          lookAgain(data_, fit_, atoms, nuisance_, screening, surprise, replicates_, seed_ + 1);
      if (again.p_value < unknown::kLevelOfSecondLook * family_wise_p) {
        add(atoms.items[again.screened.atom], again.screened, again.p_value);
      }
    }
  }

  std::vector<Dependence> result() && {
    std::sort(ranked_.begin(), ranked_.end(), [](const auto& a, const auto& b) {
      return std::tie(b.first, a.second.joint, a.second.variable) <
             std::tie(a.first, b.second.joint, b.second.variable);
    });
    std::vector<Dependence> found;
    for (auto& item : ranked_) {
      found.push_back(std::move(item.second));
    }
    return found;
  }

 private:
  void add(const Atom& atom, const Screened& screened, double p_value) {
    const auto rows = static_cast<double>(data_.rows());
    const double beyond_chance =
        std::max(0.0, screened.gain - screened.dimensions) * screened.raw_gain / screened.gain;
    const double rms_Nm =
        std::sqrt(fit_.residual.segment(atom.joint * data_.rows(), data_.rows()).squaredNorm() / rows);
    const double explained_Nm = rms_Nm * std::sqrt(std::min(1.0, beyond_chance / rows));
    if (explained_Nm < least_Nm_[static_cast<std::size_t>(atom.joint)]) {
      return;
    }
    ranked_.push_back(
        {surprise(screened.gain, screened.dimensions),
         {.joint = atom.joint, .variable = atom.label, .explained_Nm = explained_Nm, .p_value = p_value}});
  }

  const Dataset& data_;
  const ModelFit& fit_;
  std::span<const double> least_Nm_;
  Eigen::MatrixXd nuisance_;
  int replicates_;
  std::uint64_t seed_;
  std::vector<std::pair<double, Dependence>> ranked_;
};

}  // namespace

std::vector<Dependence> testDependence(const Dataset& data, const ModelFit& fit,
                                       std::span<const int> channels, std::span<const double> least_Nm,
                                       int replicates, double family_wise_p, std::uint64_t seed) {
  const auto test = [&](const ModelFit& of, double level, std::uint64_t luck) {
    Tester tester(data, of, least_Nm, replicates, luck);
    tester.test(functionAtoms(data, of, channels), (1.0 - unknown::kShareOfSwings) * level);
    tester.test(changingStiffness(data, of), unknown::kShareOfSwings * level);
    return std::move(tester).result();
  };
  std::vector<Dependence> found = test(fit, family_wise_p, seed);
  if (found.empty() && !fit.namesAny() && data.joints() > 1 &&
      fit.weighting->correlation() > unknown::kJointsAlike) {
    ModelFit apart = fit;
    apart.weighting = std::make_shared<const Weighting>(fit.weighting->jointByJoint());
    found = test(apart, unknown::kLevelOfSecondLook * family_wise_p, seed + 2);
  }
  return found;
}

}  // namespace patella::diagnose
