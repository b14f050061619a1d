#include "tools/diagnose/verdict/power.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "core/model/effect.hpp"
#include "tools/diagnose/effects/considered.hpp"
#include "tools/diagnose/effects/effect_home.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/search/candidate.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/diagnose/verdict/rehearsal.hpp"

namespace patella::diagnose {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
/// Effects that are named in a sentence.
constexpr std::size_t kTold = 5;
/// A rehearsal goes up from the size that known noise would allow, and anybody miss, in such steps, and
/// halves the last one so many times. The middle of what is left is the size, since its upper end would be 4
/// % too large in the mean.
constexpr double kStep = 2.0;
constexpr int kMostSteps = 6;
constexpr int kSizeHalvings = 3;

struct Size {
  double torque_Nm = kNever;
  Strength strength{};
  const Atom* atom = nullptr;
  Detectable shape{};
};

// `least_Nm`: torque below which nothing is missed, however little noise there is.
Size sizeOf(const Atoms& atoms, const Atom& atom, const Detector& detector, double noise_Nm,
            double structure_Nm, double least_Nm) {
  const Detectable shape = detector.of(atoms.of(atom), atom.joint);
  const double torque_Nm =
      std::max(smallestTorque_Nm(shape, detector.threshold(), noise_Nm, structure_Nm), least_Nm);
  if (!std::isfinite(torque_Nm)) {
    return {};
  }
  Strength strength = strengthAt(*atom.recipe, atom.nu, torque_Nm / shape.unit_Nm);
  return std::isinf(strength.main)
             ? Size{}
             : Size{.torque_Nm = torque_Nm, .strength = std::move(strength), .atom = &atom, .shape = shape};
}

// Not smaller than `least`, which takes noise for known.
Size rehearsed(const Size& least, const Rehearsal& rehearsal) {
  const auto asserts = [&](double factor) {
    return rehearsal.asserts(factor * least.torque_Nm / least.shape.unit_Nm);
  };
  double above = 1.0;
  for (int step = 0; !asserts(above); ++step) {
    if (step == kMostSteps) {
      return {};
    }
    above *= kStep;
  }
  double below = above / kStep;
  for (int halving = 0; halving < kSizeHalvings && above > 1.0; ++halving) {
    const double middle = std::sqrt(below * above);
    (asserts(middle) ? above : below) = middle;
  }
  Size size = least;
  size.torque_Nm *= above > 1.0 ? std::sqrt(below * above) : above;
  size.strength = strengthAt(*least.atom->recipe, least.atom->nu, size.torque_Nm / least.shape.unit_Nm);
  return std::isinf(size.strength.main) ? Size{} : size;
}

Size median(std::vector<Size> sizes) {
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end(),
                   [](const Size& a, const Size& b) { return a.torque_Nm < b.torque_Nm; });
  return *middle;
}

// A kind may have variants; the plain one comes first.
std::vector<const Atom*> plainPoints(std::span<const Atom* const> points) {
  std::vector<const Atom*> plain;
  std::copy_if(points.begin(), points.end(), std::back_inserter(plain),
               [&](const Atom* point) { return point->recipe == points.front()->recipe; });
  return plain;
}

bool isCommon(const Revealed& revealed) {
  const std::vector<std::string> common = commonKinds();
  return std::find(common.begin(), common.end(), revealed.kind) != common.end();
}

}  // namespace

Strength strengthAt(const Recipe& recipe, const std::vector<double>& point, double factor) {
  const auto& strengths = effectHome(recipe.kind).strengths;
  std::vector<double> c(recipe.coefficients(), 0.0);
  std::vector<double> nu = point;
  std::size_t index = 0;
  const auto& parameters = model::findEffect(recipe.kind)->parameters;
  if (!c.empty() && !strengths.empty()) {
    if (factor > recipe.largest) {
      return {.main = kNever};
    }
    c.front() = factor;
    const auto found = std::find_if(parameters.begin(), parameters.end(), [&](const auto& parameter) {
      return parameter.name == strengths.front().front();
    });
    index = static_cast<std::size_t>(found - parameters.begin());
  } else if (c.empty() && recipe.proportional) {
    nu.front() = std::abs(nu.front()) * factor;
    if (nu.front() > recipe.nonlinear.front().upper) {
      return {.main = kNever};
    }
  } else {
    return {};
  }
  std::vector<double> all = recipe.parameters(c, nu);
  const double value = std::abs(all[index]);
  if (value == 0.0) {
    // A variant of the kind that has another strength.
    return {};
  }
  // Beyond what the effect may be, its parameters are clamped.
  return value < parameters[index].maximum ? Strength{.main = value, .parameters = std::move(all)}
                                           : Strength{.main = kNever};
}

std::string mainParameter(std::string_view kind) {
  const auto& strengths = effectHome(kind).strengths;
  return std::string(strengths.empty() ? model::findEffect(kind)->parameters.front().name
                                       : strengths.front().front());
}

double smallestTorque_Nm(const Detectable& shape, double threshold, double noise_Nm, double structure_Nm) {
  if (!(shape.own_share > 0.0) || !std::isfinite(shape.in_noise)) {
    return kNever;
  }
  const double above_chance = shape.in_noise * (1.0 + shown::kFourInFive / std::sqrt(threshold)) * noise_Nm;
  const double above_rest =
      (asserted::kOverRest + shown::kFourInFive / std::sqrt(asserted::kLooks)) * structure_Nm;
  return std::max(above_chance, above_rest / shape.own_share);
}

Chance chanceOf(const Diagnosis& diagnosis, const ModelFit& fit) {
  return {.threshold = thresholdOf(diagnosis, fit),
          .margin = diagnosis.steps.empty() ? shown::kTypicalChance : diagnosis.steps.back().chance};
}

std::vector<Revealed> revealedBy(ModelFitter& fitter, const ModelFit& fit, const Atoms& atoms,
                                 std::span<const RestOfJoint> rests, const std::set<std::string>& known,
                                 const Chance& chance) {
  const Dataset& data = fitter.data();
  const Detector detector(data, fit, chance.threshold);
  Obstacles obstacles{
      .chance = chance.margin, .noise_Nm = {}, .structure_Nm = {}, .least_Nm = fitter.leastTorque_Nm()};
  for (const RestOfJoint& rest : rests) {
    obstacles.noise_Nm.push_back(rest.noise_Nm);
    obstacles.structure_Nm.push_back(rest.structure_Nm);
  }
  const FilteredProducts products = productsForRehearsals(fit);
  std::map<std::string, std::vector<const Atom*>> by_label;
  for (const Atom& atom : atoms.items) {
    if (atom.recipe != nullptr && !known.contains(atom.recipe->label())) {
      by_label[atom.recipe->label()].push_back(&atom);
    }
  }
  std::vector<Revealed> all;
  for (const auto& [label, points] : by_label) {
    if (givenByOthers(fitter, fit, *points.front())) {
      continue;
    }
    const int joint = points.front()->joint;
    const RestOfJoint& rest = rests[static_cast<std::size_t>(joint)];
    const double noise_Nm = jointRms(data, fit.residual, joint);
    std::vector<Size> sizes;
    for (const Atom* point : someAtoms(plainPoints(points))) {
      sizes.push_back(sizeOf(atoms, *point, detector, noise_Nm, rest.structure_Nm,
                             fitter.leastTorque_Nm()[static_cast<std::size_t>(joint)]));
    }
    Size size = median(std::move(sizes));
    if (size.atom != nullptr) {
      size = rehearsed(size, Rehearsal(data, fit, products, obstacles, atoms.of(*size.atom), joint));
    }
    const std::string& kind = points.front()->recipe->kind;
    all.push_back({.kind = kind,
                   .joint = joint,
                   .parameter = mainParameter(kind),
                   .smallest_size = size.strength.main,
                   .parameters = size.strength.parameters,
                   .torque_rms_Nm = size.torque_Nm,
                   .share_of_torque = size.torque_Nm / rest.torque_Nm});
  }
  const auto rank = [](const Revealed& revealed) {
    return std::tuple(!isCommon(revealed), -revealed.share_of_torque, revealed.kind, revealed.joint);
  };
  std::sort(all.begin(), all.end(), [&](const Revealed& a, const Revealed& b) { return rank(a) < rank(b); });
  return all;
}

std::string sizeWords(const Revealed& revealed, const Units& units) {
  if (!std::isfinite(revealed.smallest_size)) {
    return std::isfinite(revealed.torque_rms_Nm)
               ? fmt::format("{:.2g} {} rms", revealed.torque_rms_Nm, units.torque)
               : "never";
  }
  std::string words =
      fmt::format("{:.2g} {}", revealed.smallest_size, splitName(revealed.parameter, units).unit);
  // A load says little without its lever.
  const model::EffectDescriptor* descriptor = model::findEffect(revealed.kind);
  for (std::size_t p = 0; descriptor != nullptr && p < revealed.parameters.size(); ++p) {
    if (descriptor->parameters[p].name == "distance_m") {
      words += fmt::format(" at {:.2g} m", revealed.parameters[p]);
    }
  }
  return words;
}

RevealedWords revealedWords(const Diagnosis& diagnosis) {
  RevealedWords words;
  std::size_t told = 0;
  for (const Revealed& revealed : diagnosis.revealed) {
    if (told++ == kTold || !isCommon(revealed)) {
      break;
    }
    const std::string name = effectWords(fmt::format("{}@{}", revealed.kind, revealed.joint + 1));
    if (std::isfinite(revealed.torque_rms_Nm)) {
      words.shown += fmt::format("{}{} from {}", words.shown.empty() ? "" : ", ", name,
                                 sizeWords(revealed, unitsOf(diagnosis, revealed.joint)));
    } else {
      words.hidden += (words.hidden.empty() ? "" : ", ") + name;
    }
  }
  return words;
}

}  // namespace patella::diagnose
