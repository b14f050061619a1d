#include "tools/diagnose/free_function.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>

#include <fmt/format.h>

namespace patella::diagnose {
namespace {

/// Periods over the joint's range from which on a ripple is told from a bend.
constexpr double kPlainCycles = 2.5;

double positionRange(const Dataset& data, int joint) {
  double low = std::numeric_limits<double>::max();
  double high = std::numeric_limits<double>::lowest();
  for (const Series& series : data.series()) {
    for (const model::EffectInput& state : series.states) {
      low = std::min(low, state.q[joint]);
      high = std::max(high, state.q[joint]);
    }
  }
  return high - low;
}

bool bends(const Dataset& data, const Term& term) {
  return term.recipe->kind == "torque_ripple" &&
         term.nu[0] * positionRange(data, term.recipe->joint) < kPlainCycles;
}

// Torque of these terms as the fit has it.
double torqueRms(const Dataset& data, const ModelFit& fit, const std::vector<std::size_t>& terms, int joint) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(data.rows());
  for (const std::size_t t : terms) {
    const auto& c = fit.terms[t].c;
    for (std::size_t k = 0; k < c.size(); ++k) {
      sum += c[k] * fit.tangent.col(fit.offset[t] + static_cast<Eigen::Index>(k))
                        .segment(joint * data.rows(), data.rows());
    }
  }
  return std::sqrt(sum.squaredNorm() / static_cast<double>(data.rows()));
}

}  // namespace

std::vector<FreeFunction> freeFunctions(const Dataset& data, const Selection& selection) {
  std::vector<FreeFunction> found;
  for (int joint = 0; joint < data.joints(); ++joint) {
    std::vector<std::size_t> of_position;
    std::vector<std::size_t> reflexes;
    bool bent = false;
    for (std::size_t t = 0; t < selection.fit.terms.size(); ++t) {
      const Term& term = selection.fit.terms[t];
      if (term.declared || term.recipe->joint != joint) {
        continue;
      }
      // A constant belongs to any function of the position.
      if (betrayingVariable(term.recipe->kind) == "q" || term.recipe->kind == "torque_bias") {
        of_position.push_back(t);
        bent = bent || bends(data, term);
      } else if (term.recipe->kind == "spasticity") {
        reflexes.push_back(t);
      }
    }
    const auto add = [&](const std::vector<std::size_t>& terms, std::string_view stem) {
      double p_value = 0.0;
      for (const std::size_t t : terms) {
        p_value = std::max(p_value, selection.evidence[t].p_value);
      }
      found.push_back({.terms = terms,
                       .dependence = {.joint = joint,
                                      .variable = fmt::format("{}{}", stem, joint + 1),
                                      .explained_Nm = torqueRms(data, selection.fit, terms, joint),
                                      .p_value = p_value}});
    };
    if (bent && of_position.size() > 1) {
      add(of_position, "q");
    }
    if (reflexes.size() > 1) {
      add(reflexes, "dq");
    }
  }
  return found;
}

}  // namespace patella::diagnose
