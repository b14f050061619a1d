#include "firmware_app/files/urdf_elements.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <vector>

#include <boost/property_tree/ptree.hpp>
#include <boost/property_tree/xml_parser.hpp>

#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

using Xml = boost::property_tree::ptree;
using Names = std::vector<std::string>;

const std::string kAttributes = "<xmlattr>";

/// An element whose attributes are numbers.
struct NumberElement {
  std::string name;
  Names attributes;
  std::size_t numbers;  // in each attribute
  bool complete;        // all attributes have to be there
};

const NumberElement kOrigin{"origin", {"xyz", "rpy"}, 3, false};
const NumberElement kAxis{"axis", {"xyz"}, 3, true};
const NumberElement kMass{"mass", {"value"}, 1, true};
const NumberElement kInertia{"inertia", {"ixx", "ixy", "ixz", "iyy", "iyz", "izz"}, 1, true};

const Names kOfLink{"inertial", "visual", "collision"};
const Names kOfInertial{"origin", "mass", "inertia"};
const Names kOfJoint{"parent", "child",       "origin",           "axis", "limit", "dynamics",
                     "mimic",  "calibration", "safety_controller"};
/// What simulators and planners put beside those, without a word about rigid bodies.
const Names kOfOtherPrograms{"material",
                             "gazebo",
                             "sensor",
                             "transmission",
                             "contact",
                             "verbose",
                             "contact_coefficients",
                             "self_collision_checking"};

bool among(const std::string& name, const Names& names) {
  return std::ranges::find(names, name) != names.end();
}

/// A name with a prefix is of another program's own namespace.
bool isForeign(const std::string& name) {
  return name.find(':') != std::string::npos || among(name, kOfOtherPrograms);
}

bool isWholeNumber(std::string word) {
  word.erase(0, word.starts_with('+') ? 1 : 0);
  double value = 0.0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc{} && end == word.data() + word.size() && std::isfinite(value);
}

bool holdsNumbers(const std::string& text, std::size_t count) {
  std::istringstream words(text);
  std::size_t found = 0;
  for (std::string word; words >> word; ++found) {
    if (!isWholeNumber(word)) {
      return false;
    }
  }
  return found == count;
}

/// One link or joint, with the words that messages about it begin with.
class Part {
 public:
  Part(std::string where, const Xml& xml) : where_(std::move(where)), xml_(xml) {}

  /// What is in it, or in `inner` of it, is among `known`.
  void holdsOnly(const Names& known, const Xml& within, const std::string& inner = {}) const {
    for (const auto& [name, element] : within) {
      if (name != kAttributes && !name.empty() && !among(name, known) && !isForeign(name)) {
        throw refused(inner + "element <" + name + ">",
                      "one of " + quotedList(known) + suggestion(name, known));
      }
    }
  }
  void holdsOnce(const NumberElement& kind, const Xml& within, const std::string& inner = {}) const {
    onlyOne(kind.name, within, inner);
    const auto element = within.get_child_optional(kind.name);
    if (!element) {
      return;
    }
    const Xml attributes = element->get_child(kAttributes, Xml());
    const std::string here = inner + "<" + kind.name + ">";
    for (const auto& [name, value] : attributes) {
      if (!among(name, kind.attributes) && !isForeign(name)) {
        throw refused(here + ": attribute '" + name + "'",
                      "one of " + quotedList(kind.attributes) + suggestion(name, kind.attributes));
      }
    }
    for (const std::string& name : kind.attributes) {
      const auto value = attributes.get_optional<std::string>(name);
      if (!value && kind.complete) {
        throw refused(here + " has no attribute '" + name + "'", numberWords(kind));
      }
      if (value && !holdsNumbers(*value, kind.numbers)) {
        throw refused(here + ": " + name + " = '" + *value + "'", numberWords(kind));
      }
    }
  }
  void onlyOne(const std::string& name, const Xml& within, const std::string& inner = {}) const {
    if (within.count(name) > 1) {
      throw refused(inner + "<" + name + "> stands " + std::to_string(within.count(name)) + " times",
                    "it once");
    }
  }
  void has(const std::string& name, const Xml& within, const std::string& inner) const {
    if (within.count(name) == 0) {
      throw refused(inner + "no <" + name + ">", "one");
    }
  }
  const Xml& xml() const noexcept { return xml_; }

 private:
  static std::string numberWords(const NumberElement& kind) {
    return kind.numbers == 1 ? "a number" : std::to_string(kind.numbers) + " numbers with spaces between";
  }
  FileError refused(const std::string& what, const std::string& expected) const {
    return FileError(where_ + what + ", expected " + expected);
  }

  std::string where_;
  const Xml& xml_;
};

void checkLinkElement(const Part& link) {
  link.holdsOnly(kOfLink, link.xml());
  link.onlyOne("inertial", link.xml());
  if (const auto inertial = link.xml().get_child_optional("inertial")) {
    const std::string inner = "<inertial>: ";
    link.holdsOnly(kOfInertial, *inertial, inner);
    link.has("mass", *inertial, inner);
    link.has("inertia", *inertial, inner);
    for (const NumberElement& kind : {kOrigin, kMass, kInertia}) {
      link.holdsOnce(kind, *inertial, inner);
    }
  }
}

void checkJointElement(const Part& joint) {
  joint.holdsOnly(kOfJoint, joint.xml());
  joint.holdsOnce(kOrigin, joint.xml());
  joint.holdsOnce(kAxis, joint.xml());
}

Xml readXml(std::string_view text, const std::string& file) {
  std::istringstream stream{std::string(text)};
  Xml tree;
  try {
    read_xml(stream, tree, boost::property_tree::xml_parser::no_comments);
  } catch (const boost::property_tree::xml_parser_error& error) {
    throw FileError(file + ": is no URDF (line " + std::to_string(error.line()) + ": " + error.message() +
                    "), expected XML");
  }
  return tree;
}

}  // namespace

void checkUrdfElements(std::string_view text, const std::string& file, const UrdfConcern& concerns) {
  const Xml tree = readXml(text, file);
  const auto robot = tree.get_child_optional("robot");
  if (!robot) {
    return;  // urdfdom refuses that
  }
  for (const auto& [element, xml] : *robot) {
    const bool is_link = element == "link";
    if (!is_link && element != "joint") {
      continue;
    }
    const std::string name = xml.get(kAttributes + ".name", std::string());
    if (!concerns(element, name)) {
      continue;
    }
    const Part part(file + ": " + element + " '" + name + "': ", xml);
    is_link ? checkLinkElement(part) : checkJointElement(part);
  }
}

}  // namespace patella::app
