#include "tools/diagnose/fit/physical_parameters.hpp"

#include <stdexcept>
#include <variant>

#include <fmt/format.h>

namespace patella::diagnose {

std::vector<PhysicalParameter> physicalParameters(model::MechanismDescription& mechanism) {
  if (model::isSerialChain(mechanism)) {
    throw std::invalid_argument(
        "diagnosis: a model of kind 'serial_chain', expected 'planar_two_link', 'revolute' or 'prismatic'");
  }
  std::vector<PhysicalParameter> all;
  if (auto* leg = std::get_if<model::PlanarTwoLinkParameters>(&mechanism)) {
    for (std::size_t link = 0; link < 2; ++link) {
      const std::string index = fmt::format("[{}]", link + 1);
      all.push_back({"mass_kg" + index, &leg->mass_kg[link], boundOf("mechanism.mass_kg (planar_two_link)")});
      all.push_back({"com_m" + index, &leg->com_m[link], boundOf("mechanism.com_m (planar_two_link)")});
      all.push_back({"inertia_kg_m2" + index, &leg->inertia_kg_m2[link],
                     boundOf("mechanism.inertia_kg_m2 (planar_two_link)")});
    }
  } else if (auto* joint = std::get_if<model::RevoluteJointParameters>(&mechanism)) {
    all.push_back({"inertia_kg_m2", &joint->inertia_kg_m2, boundOf("mechanism.inertia_kg_m2 (revolute)")});
    all.push_back({"moment_kg_m", &joint->moment_kg_m, boundOf("mechanism.moment_kg_m (revolute)")});
  } else {
    all.push_back({"mass_kg", &std::get<model::PrismaticJointParameters>(mechanism).mass_kg,
                   boundOf("mechanism.mass_kg (prismatic)")});
  }
  std::erase_if(all, [](const PhysicalParameter& item) { return *item.value == 0.0; });
  return all;
}

}  // namespace patella::diagnose
