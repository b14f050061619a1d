#include "firmware_app/files/model_file.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <variant>
#include <vector>

#include "core/model/effect.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/base_parameters.hpp"
#include "firmware_app/files/bounded.hpp"
#include "firmware_app/files/chain_table.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

using model::EffectDescription;
using model::MechanismDescription;
using model::ModelDescription;
using model::PlanarTwoLinkParameters;
using model::PrismaticJointParameters;
using model::RevoluteJointParameters;

constexpr const char* kPlanarTwoLink = "planar_two_link";
constexpr const char* kRevolute = "revolute";
constexpr const char* kPrismatic = "prismatic";
constexpr const char* kSerialChain = "serial_chain";

template <typename... Visitors>
struct Overloaded : Visitors... {
  using Visitors::operator()...;
};
template <typename... Visitors>
Overloaded(Visitors...) -> Overloaded<Visitors...>;

std::array<double, 2> readPair(const TomlTable& table, const Bound& bound) {
  const std::vector<double> values = numbers(table, bound, CountRange::exactly(2));
  return {values[0], values[1]};
}

PlanarTwoLinkParameters readBaseParameters(const TomlTable& mechanism, double gravity_m_s2) {
  for (const char* key : {"mass_kg", "com_m", "inertia_kg_m2"}) {
    if (mechanism.has(key)) {
      throw mechanism.error(key, "stands beside 'base_parameters', which tell it; expected one of the two");
    }
  }
  const TomlTable table = mechanism.table("base_parameters");
  const BaseParametersOfLinks base{
      .thigh_inertia_kg_m2 =
          number(table, boundOf("mechanism.base_parameters.thigh_inertia_kg_m2 (planar_two_link)")),
      .shank_inertia_kg_m2 =
          number(table, boundOf("mechanism.base_parameters.shank_inertia_kg_m2 (planar_two_link)")),
      .thigh_moment_kg_m =
          number(table, boundOf("mechanism.base_parameters.thigh_moment_kg_m (planar_two_link)")),
      .shank_moment_kg_m =
          number(table, boundOf("mechanism.base_parameters.shank_moment_kg_m (planar_two_link)"))};
  const std::array<double, 2> length_m = readPair(mechanism, boundOf("mechanism.length_m (planar_two_link)"));
  try {
    return model::PlanarTwoLink(linksOf(base, length_m, gravity_m_s2)).parameters();
  } catch (const std::invalid_argument& error) {
    throw mechanism.error("base_parameters", error.what());
  }
}

MechanismDescription readMechanism(const TomlTable& table, std::vector<std::filesystem::path>& files) {
  const std::string kind =
      table.choice("kind", std::vector<std::string>{kPlanarTwoLink, kRevolute, kPrismatic, kSerialChain});
  if (kind == kSerialChain) {
    if (table.has("chain")) {
      return readChainGroup(table, files);
    }
    return readChain(table, files);
  }
  const double gravity = number(table, boundOf("mechanism.gravity_m_s2"), 9.81);
  if (kind == kPlanarTwoLink && table.has("base_parameters")) {
    return readBaseParameters(table, gravity);
  }
  if (kind == kPlanarTwoLink) {
    return PlanarTwoLinkParameters{
        .mass_kg = readPair(table, boundOf("mechanism.mass_kg (planar_two_link)")),
        .length_m = readPair(table, boundOf("mechanism.length_m (planar_two_link)")),
        .com_m = readPair(table, boundOf("mechanism.com_m (planar_two_link)")),
        .inertia_kg_m2 = readPair(table, boundOf("mechanism.inertia_kg_m2 (planar_two_link)")),
        .gravity_m_s2 = gravity};
  }
  if (kind == kRevolute) {
    return RevoluteJointParameters{
        .inertia_kg_m2 = number(table, boundOf("mechanism.inertia_kg_m2 (revolute)")),
        .moment_kg_m = number(table, boundOf("mechanism.moment_kg_m (revolute)")),
        .length_m = number(table, boundOf("mechanism.length_m (revolute)")),
        .gravity_m_s2 = gravity};
  }
  return PrismaticJointParameters{
      .mass_kg = number(table, boundOf("mechanism.mass_kg (prismatic)")),
      .inclination_rad = number(table, boundOf("mechanism.inclination_rad (prismatic)"), 0.0),
      .gravity_m_s2 = gravity};
}

std::vector<std::string> knownEffects() {
  std::vector<std::string> kinds;
  for (const model::EffectDescriptor* descriptor : model::effectCatalogue()) {
    kinds.emplace_back(descriptor->kind);
  }
  return kinds;
}

EffectDescription readEffect(const TomlTable& table, int joints) {
  EffectDescription effect;
  effect.kind = table.choice("kind", knownEffects());
  effect.joint = static_cast<int>(table.integer("joint", 1, joints)) - 1;
  for (const model::EffectParameter& parameter : model::findEffect(effect.kind)->parameters) {
    const Range range{.minimum = parameter.minimum, .maximum = parameter.maximum};
    // A physical value has to be stated; a choice of modelling has a sensible default.
    effect.parameters.push_back(parameter.identified
                                    ? table.number(parameter.name, range)
                                    : table.number(parameter.name, range, parameter.initial));
  }
  return effect;
}

std::string assignment(std::string_view key, const std::string& value, const std::string& comment) {
  return std::string(key) + " = " + value + (comment.empty() ? "" : "  # " + comment) + "\n";
}

std::string assignment(std::string_view key, double value, const std::string& comment) {
  return assignment(key, formatNumber(value), comment);
}

std::string assignment(std::string_view key, const std::array<double, 2>& pair, const std::string& comment) {
  return assignment(key, "[" + formatNumber(pair[0]) + ", " + formatNumber(pair[1]) + "]", comment);
}

std::string kindLine(std::string_view kind) {
  return assignment("kind", "\"" + std::string(kind) + "\"", "");
}

std::string mechanismText(const MechanismDescription& description) {
  const std::string gravity_comment = "m/s², downwards";
  return "[mechanism]\n" +
         std::visit(
             Overloaded{
                 [&](const PlanarTwoLinkParameters& leg) {
                   return kindLine(kPlanarTwoLink) + assignment("mass_kg", leg.mass_kg, "kg; thigh, shank") +
                          assignment("length_m", leg.length_m, "m; hip to knee, knee to end point") +
                          assignment("com_m", leg.com_m, "m; joint to centre of mass, along the link") +
                          assignment("inertia_kg_m2", leg.inertia_kg_m2, "kg·m², about the centre of mass") +
                          assignment("gravity_m_s2", leg.gravity_m_s2, gravity_comment);
                 },
                 [&](const RevoluteJointParameters& joint) {
                   return kindLine(kRevolute) +
                          assignment("inertia_kg_m2", joint.inertia_kg_m2, "kg·m², about the axis") +
                          assignment("moment_kg_m", joint.moment_kg_m,
                                     "kg·m; mass times distance of its centre from the axis") +
                          assignment("length_m", joint.length_m, "m; axis to end point") +
                          assignment("gravity_m_s2", joint.gravity_m_s2, gravity_comment);
                 },
                 [&](const PrismaticJointParameters& axis) {
                   return kindLine(kPrismatic) + assignment("mass_kg", axis.mass_kg, "kg") +
                          assignment("inclination_rad", axis.inclination_rad,
                                     "rad; direction of motion above the horizontal") +
                          assignment("gravity_m_s2", axis.gravity_m_s2, gravity_comment);
                 },
                 [&](const model::SerialChainParameters& chain) {
                   return kindLine(kSerialChain) + chainText(chain);
                 },
                 [&](const model::ChainGroupParameters& group) {
                   return kindLine(kSerialChain) + chainText(group);
                 }},
             description);
}

std::string effectText(const EffectDescription& effect) {
  const model::EffectDescriptor* descriptor = model::findEffect(effect.kind);
  std::string text = "\n# " + std::string(descriptor->equation) + "\n[[effect]]\n" + kindLine(effect.kind) +
                     assignment("joint", std::to_string(effect.joint + 1), "");
  for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
    const model::EffectParameter& parameter = descriptor->parameters[i];
    text += assignment(parameter.name, effect.parameters[i],
                       std::string(parameter.meaning) + ", " + formatNumber(parameter.minimum) + " to " +
                           formatNumber(parameter.maximum));
  }
  return text;
}

std::string commentLines(std::string_view text) {
  std::string lines;
  while (!text.empty()) {
    const auto end = std::min(text.find('\n'), text.size());
    lines += "# " + std::string(text.substr(0, end)) + "\n";
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

}  // namespace

ModelDescription loadModel(const std::filesystem::path& path, std::vector<std::filesystem::path>* urdfs) {
  return parseModel(readFile(path), path.string(), urdfs);
}

ModelDescription parseModel(std::string_view text, const std::string& name,
                            std::vector<std::filesystem::path>* urdfs) {
  const TomlDocument document = TomlDocument::parse(text, name);
  std::vector<std::filesystem::path> files;
  ModelDescription description{.mechanism = readMechanism(document.root().table("mechanism"), files),
                               .effects = {}};
  if (urdfs != nullptr) {
    *urdfs = files;
  }
  for (const TomlTable& table : document.root().tables("effect")) {
    description.effects.push_back(readEffect(table, description.joints()));
  }
  document.finish();
  try {
    makeModel(description);
  } catch (const std::invalid_argument& error) {
    // An effect that does not fit names itself.
    const std::string problem = error.what();
    const bool of_chain = problem.starts_with("link ") || problem.starts_with("chain ") ||
                          problem.starts_with("serial_chain: ");
    throw of_chain ? chainError(document.root().table("mechanism"), problem)
                   : FileError(name + ": " + problem);
  }
  return description;
}

std::string modelText(const ModelDescription& description, std::string_view heading) {
  std::string text = commentLines(heading) + mechanismText(description.mechanism);
  for (const EffectDescription& effect : description.effects) {
    text += effectText(effect);
  }
  return text;
}

void saveModel(const ModelDescription& description, const std::filesystem::path& path,
               std::string_view heading) {
  makeModel(description);
  writeFile(path, modelText(description, heading));
}

}  // namespace patella::app
