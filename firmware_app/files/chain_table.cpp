#include "firmware_app/files/chain_table.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "core/bounds/bounds.hpp"
#include "drivers/joined.hpp"
#include "firmware_app/files/bounded.hpp"
#include "firmware_app/files/urdf_file.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

using model::ChainGroupParameters;
using model::ChainJoint;
using model::ChainLink;
using model::SerialChainParameters;

const std::vector<std::string> kJointKinds{"fixed", "revolute", "prismatic"};

Eigen::Vector3d readVector(const TomlTable& table, const Bound& bound, const Eigen::Vector3d& fallback) {
  const std::vector<double> values = numbers(table, bound, CountRange::exactly(3), {fallback.data(), 3});
  return {values[0], values[1], values[2]};
}

ChainLink readLink(const TomlTable& table) {
  ChainLink link;
  link.name = table.string("name");
  const std::string joint = table.choice("joint", kJointKinds);
  link.joint =
      static_cast<ChainJoint>(std::find(kJointKinds.begin(), kJointKinds.end(), joint) - kJointKinds.begin());
  link.origin_m = readVector(table, boundOf("mechanism.link.origin_m (serial_chain)"), link.origin_m);
  link.turn_rad = readVector(table, boundOf("mechanism.link.turn_rad (serial_chain)"), link.turn_rad);
  if (link.joint != ChainJoint::kFixed) {
    link.axis = readVector(table, boundOf("mechanism.link.axis (serial_chain)"), link.axis);
  }
  link.mass_kg = number(table, boundOf("mechanism.link.mass_kg (serial_chain)"), link.mass_kg);
  link.com_m = readVector(table, boundOf("mechanism.link.com_m (serial_chain)"), link.com_m);
  const auto inertia = numbers(table, boundOf("mechanism.link.inertia_kg_m2 (serial_chain)"),
                               CountRange::exactly(link.inertia_kg_m2.size()), link.inertia_kg_m2);
  std::copy(inertia.begin(), inertia.end(), link.inertia_kg_m2.begin());
  return link;
}

std::string listed(std::span<const double> values) {
  // TOML's -0 is a whole number, and so 0.
  return "[" + joined(values, ", ", [](double value) { return formatNumber(value + 0.0); }) + "]";
}

std::string line(const char* key, std::span<const double> values, const char* comment) {
  return std::string(key) + " = " + listed(values) + "  # " + comment + "\n";
}

std::string line(const char* key, const Eigen::Vector3d& values, const char* comment) {
  return line(key, std::span<const double>(values.data(), 3), comment);
}

/// A basic string of TOML.
std::string quoted(const std::string& text) {
  constexpr unsigned char kFirstPrinted = 0x20;
  constexpr unsigned char kDelete = 0x7F;
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (c == '"' || c == '\\') {
      result += std::string("\\") + c;
    } else if (code < kFirstPrinted || code == kDelete) {
      constexpr const char* kDigits = "0123456789ABCDEF";
      result += std::string("\\u00") + kDigits[code / 16] + kDigits[code % 16];
    } else {
      result += c;
    }
  }
  return result + "\"";
}

Eigen::Vector3d readGravity(const TomlTable& mechanism) {
  return readVector(mechanism, boundOf("mechanism.gravity_m_s2 (serial_chain)"),
                    SerialChainParameters{}.gravity_m_s2);
}

/// `link`: a link's table with those that it is in, for messages.
std::vector<ChainLink> readLinks(const TomlTable& chain, const std::string& link,
                                 std::vector<std::filesystem::path>& files) {
  if (chain.has("urdf")) {
    if (chain.has("link")) {
      throw chain.error("link", "stands beside 'urdf', which has the links; expected one of the two");
    }
    files.push_back(chain.existing("urdf"));
    return loadUrdfChain(files.back(), chain.string("base"), chain.string("tip"));
  }
  std::vector<ChainLink> links;
  for (const TomlTable& table : chain.tables("link")) {
    links.push_back(readLink(table));
  }
  if (links.empty()) {
    throw chain.error("link", "missing, expected a table [[" + link + "]] for each link, or 'urdf'");
  }
  return links;
}

/// "link 2 'shank': mass_kg = 0, expected more", at the line of that link and key; another problem at the
/// links.
FileError located(const TomlTable& chain, const std::string& problem) {
  const std::size_t end = problem.find("': ");
  if (!problem.starts_with("link ") || !chain.has("link") || end == std::string::npos) {
    return chain.error(chain.has("urdf") ? "urdf" : chain.has("chain") ? "chain" : "link", problem);
  }
  const std::string rest = problem.substr(end + 3);
  const std::string key = rest.substr(0, rest.find_first_of(" :"));
  const std::vector<TomlTable> tables = chain.tables("link");
  const TomlTable& table = tables.at(std::stoul(problem.substr(std::string_view("link ").size())) - 1);
  return table.has(key) ? table.error(key, rest) : table.error("name", problem);
}

std::string gravityText(const SerialChainParameters& chain) {
  return line("gravity_m_s2", chain.gravity_m_s2, "m/s², in the axes of the base");
}

std::string linksText(const SerialChainParameters& chain, const std::string& table) {
  std::string text;
  for (const ChainLink& link : chain.links) {
    text += "\n[[" + table + "]]\nname = " + quoted(link.name) + "\njoint = \"" +
            kJointKinds[static_cast<std::size_t>(link.joint)] + "\"\n" +
            line("origin_m", link.origin_m, "m; of the joint, in the frame of the link before") +
            line("turn_rad", link.turn_rad, "rad; roll, pitch, yaw");
    if (link.joint != ChainJoint::kFixed) {
      text += line("axis", link.axis, "in the joint's frame");
    }
    text +=
        "mass_kg = " + formatNumber(link.mass_kg) + "  # kg\n" +
        line("com_m", link.com_m, "m; centre of mass in the link's frame") +
        line("inertia_kg_m2", link.inertia_kg_m2, "kg·m², about the centre of mass: xx, yy, zz, xy, xz, yz");
  }
  return text;
}

}  // namespace

SerialChainParameters readChain(const TomlTable& mechanism, std::vector<std::filesystem::path>& files) {
  return {.links = readLinks(mechanism, "mechanism.link", files), .gravity_m_s2 = readGravity(mechanism)};
}

ChainGroupParameters readChainGroup(const TomlTable& mechanism, std::vector<std::filesystem::path>& files) {
  for (const char* key : {"urdf", "base", "tip", "link"}) {
    if (mechanism.has(key)) {
      throw mechanism.error(key, "stands beside 'chain', expected it within a table [[mechanism.chain]]");
    }
  }
  const Eigen::Vector3d gravity_m_s2 = readGravity(mechanism);
  ChainGroupParameters group;
  for (const TomlTable& table : mechanism.tables("chain")) {
    group.chains.push_back(
        {.links = readLinks(table, "mechanism.chain.link", files), .gravity_m_s2 = gravity_m_s2});
  }
  return group;
}

FileError chainError(const TomlTable& mechanism, const std::string& problem) {
  constexpr std::string_view kChain = "chain ";
  const std::size_t end = problem.find(": ");
  if (!mechanism.has("chain") || !problem.starts_with(kChain) || end == std::string::npos) {
    return located(mechanism, problem);
  }
  const std::vector<TomlTable> chains = mechanism.tables("chain");
  return located(chains.at(std::stoul(problem.substr(kChain.size())) - 1), problem.substr(end + 2));
}

std::string chainText(const SerialChainParameters& chain) {
  return gravityText(chain) + linksText(chain, "mechanism.link");
}

std::string chainText(const ChainGroupParameters& group) {
  std::string text = gravityText(group.chains.front());
  for (const SerialChainParameters& chain : group.chains) {
    text += "\n[[mechanism.chain]]\n" + linksText(chain, "mechanism.chain.link");
  }
  return text;
}

}  // namespace patella::app
