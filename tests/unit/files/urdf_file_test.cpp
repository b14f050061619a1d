// Chains of URDF files: what is read, and what is refused with which words.
#include "firmware_app/files/urdf_file.hpp"

#include <string>

#include <doctest/doctest.h>

#include "core/model/serial_chain.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "tests/support/joint_pair.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella;
using namespace patella::app;
using patella::model::ChainJoint;
using patella::model::ChainLink;
using patella::test::messageOf;
using patella::test::ScratchFolder;

namespace {

std::string link(const std::string& name, const std::string& inertial = {}) {
  return "<link name=\"" + name + "\">" + inertial + "</link>\n";
}

std::string inertial(const std::string& mass, const std::string& diagonal, const std::string& origin = {}) {
  return "<inertial>" + origin + "<mass value=\"" + mass + "\"/><inertia ixx=\"" + diagonal + "\" iyy=\"" +
         diagonal + "\" izz=\"" + diagonal + "\" ixy=\"0\" ixz=\"0\" iyz=\"0\"/></inertial>";
}

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& more = "<axis xyz=\"0 0 1\"/>") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/><origin xyz=\"0.1 0 0\" rpy=\"0 0 0\"/>" + more +
         "<limit effort=\"1\" velocity=\"1\" lower=\"-1\" upper=\"1\"/></joint>\n";
}

std::string robot(const std::string& content) {
  return "<robot name=\"r\">\n" + content + "</robot>\n";
}

/// A base, a knee and a foot, with another link beside the knee.
std::string leg(const std::string& knee = joint("knee", "revolute", "base", "shank"),
                const std::string& shank = link("shank", inertial("3", "0.1"))) {
  return robot(link("base") + shank + link("foot") + link("horn", inertial("9", "0.1")) + knee +
               joint("ankle", "fixed", "shank", "foot") + joint("branch", "fixed", "base", "horn"));
}

const std::string kNothing = "(nothing was thrown)";

std::string errorOf(const std::string& text, const std::string& base = "base",
                    const std::string& tip = "foot") {
  return messageOf<FileError>([&] { parseUrdfChain(text, "r.urdf", base, tip); });
}

bool contains(const std::string& text, const std::string& part) {
  CAPTURE(text);
  CAPTURE(part);
  const bool found = text.find(part) != std::string::npos;
  CHECK(found);
  return found;
}

}  // namespace

TEST_CASE("links from base to tip are read, and what branches off is left out") {
  const auto links = parseUrdfChain(leg(), "r.urdf", "base", "foot");
  REQUIRE(links.size() == 2);
  CHECK(links[0].name == "shank");
  CHECK(links[0].joint == ChainJoint::kRevolute);
  CHECK(links[0].origin_m.x() == 0.1);
  CHECK(links[0].mass_kg == 3.0);
  CHECK(links[1].name == "foot");
  CHECK(links[1].joint == ChainJoint::kFixed);
}

TEST_CASE("an inertial frame that is turned is turned into the link's axes, and axes have length 1") {
  const std::string turned =
      "<inertial><origin xyz=\"0.1 0.2 0.3\" rpy=\"0 0 1.5707963267948966\"/><mass value=\"3\"/>"
      "<inertia ixx=\"0.1\" iyy=\"0.2\" izz=\"0.25\" ixy=\"0.01\" ixz=\"0.02\" iyz=\"0.03\"/></inertial>";
  const auto links = parseUrdfChain(
      leg(joint("knee", "continuous", "base", "shank", "<axis xyz=\"0 3 4\"/>"), link("shank", turned)),
      "r.urdf", "base", "foot");
  const auto [xx, yy, zz, xy, xz, yz] = links[0].inertia_kg_m2;
  // A quarter turn about z: x becomes y, y becomes −x.
  CHECK(xx == doctest::Approx(0.2));
  CHECK(yy == doctest::Approx(0.1));
  CHECK(zz == doctest::Approx(0.25));
  CHECK(xy == doctest::Approx(-0.01));
  CHECK(xz == doctest::Approx(-0.03));
  CHECK(yz == doctest::Approx(0.02));
  CHECK(links[0].com_m.isApprox(Eigen::Vector3d(0.1, 0.2, 0.3)));
  CHECK(links[0].axis.isApprox(Eigen::Vector3d(0.0, 0.6, 0.8)));
}

TEST_CASE("what is no URDF, and names that it does not have, are refused by name") {
  contains(errorOf("hip = 3"), "r.urdf: is no URDF (");
  contains(errorOf("<robot name=\"r\"><link name=\"a\"></robot>"), "r.urdf: is no URDF (");
  contains(errorOf(robot(link("foot") + joint("weld", "fixed", "world", "foot"))), "world");
  contains(errorOf(leg(), "hip"),
           "r.urdf: base 'hip' is no link of it, expected one of 'base', 'foot', 'horn', 'shank'");
  contains(errorOf(leg(), "base", "toe"), "r.urdf: tip 'toe' is no link of it, expected one of 'base'");
  contains(errorOf(leg(), "horn", "foot"),
           "tip 'foot' is not beyond base 'horn', expected a base of its way");
  contains(errorOf(leg(), "foot", "foot"), "tip 'foot' is not beyond base 'foot'");
  contains(errorOf(robot(link("base") + link("shank") + link("foot") + joint("a", "fixed", "shank", "foot") +
                         joint("b", "fixed", "foot", "shank"))),
           "r.urdf: the links above tip 'foot' are a circle, expected a tree");
  contains(messageOf<FileError>([] { loadUrdfChain("no/such.urdf", "base", "foot"); }), "no/such.urdf");
}

TEST_CASE("joints that a chain cannot have are refused by name and kind") {
  contains(errorOf(leg(joint("knee", "floating", "base", "shank"))),
           "r.urdf: joint 'knee' is floating, expected fixed, revolute, continuous or prismatic joints");
  contains(errorOf(leg(joint("knee", "planar", "base", "shank"))), "joint 'knee' is planar");
  contains(
      errorOf(leg(joint("knee", "revolute", "base", "shank", "<axis xyz=\"0 0 1\"/><mimic joint=\"hip\"/>"))),
      "joint 'knee' mimics joint 'hip'");
  contains(errorOf(leg(joint("knee", "revolute", "base", "shank", "<axis xyz=\"0 0 0\"/>"))),
           "joint 'knee': axis 0 0 0, expected a direction");
  contains(errorOf(leg(joint("knee", "fixed", "base", "shank"))),
           "from 'base' to 'foot': serial_chain: 0 joints that are not fixed, expected 1 to 8");
  std::string snake = link("base");
  std::string before = "base";
  for (int i = 1; i <= 9; ++i) {
    const std::string name = "l" + std::to_string(i);
    snake += link(name, inertial("1", "0.1")) + joint("j" + std::to_string(i), "revolute", before, name);
    before = name;
  }
  contains(errorOf(robot(snake), "base", "l9"), "9 joints that are not fixed, expected 1 to 8");
  CHECK(parseUrdfChain(robot(snake), "r.urdf", "base", "l8").size() == 8);
}

TEST_CASE("what is no number in full is refused with link or joint, value and expectation") {
  const auto of_shank = [](const std::string& body) {
    return errorOf(leg(joint("knee", "revolute", "base", "shank"), link("shank", body)));
  };
  contains(of_shank(inertial("8,393", "0.1")),
           "r.urdf: link 'shank': <inertial>: <mass>: value = '8,393', expected a number");
  contains(of_shank(inertial("abc", "0.1")), "value = 'abc', expected a number");
  contains(of_shank(inertial("inf", "0.1")), "value = 'inf', expected a number");
  contains(of_shank(inertial("3", "x")), "<inertia>: ixx = 'x', expected a number");
  contains(of_shank(inertial("3", "0.1", "<origin xyz=\"0 0\"/>")),
           "<origin>: xyz = '0 0', expected 3 numbers with spaces between");
  contains(of_shank(inertial("3", "0.1", "<origin xyz=\"0 0 1m\"/>")), "xyz = '0 0 1m'");
  const auto of_knee = [](const std::string& more) {
    return errorOf(leg(joint("knee", "revolute", "base", "shank", more)));
  };
  contains(of_knee("<axis xyz=\"0 0 z\"/>"),
           "r.urdf: joint 'knee': <axis>: xyz = '0 0 z', expected 3 numbers");
  contains(of_knee("<axis xyz=\"0,0,1\"/>"), "xyz = '0,0,1', expected 3 numbers");
  CHECK(errorOf(leg(joint("knee", "revolute", "base", "shank", "<axis xyz=\" 0 +0 1e0 \"/>"))) == kNothing);
}

TEST_CASE("an element or attribute that a chain would miss is refused by its name") {
  const auto of_shank = [](const std::string& body) {
    return errorOf(leg(joint("knee", "revolute", "base", "shank"), link("shank", body)));
  };
  contains(
      of_shank("<inertia><mass value=\"3\"/></inertia>"),
      "r.urdf: link 'shank': element <inertia>, expected one of 'inertial', 'visual', 'collision', did you "
      "mean 'inertial'?");
  contains(
      of_shank("<inertial><mas value=\"3\"/></inertial>"),
      "link 'shank': <inertial>: element <mas>, expected one of 'origin', 'mass', 'inertia', did you mean "
      "'mass'?");
  contains(of_shank("<inertial><mass value=\"3\"/></inertial>"), "<inertial>: no <inertia>, expected one");
  contains(of_shank("<inertial><mass weight=\"3\"/><inertia/></inertial>"), "<mass>: attribute 'weight'");
  contains(of_shank("<inertial><mass value=\"3\"/><inertia ixx=\"1\"/></inertial>"),
           "<inertia> has no attribute 'ixy', expected a number");
  contains(of_shank(inertial("3", "0.1") + inertial("4", "0.1")),
           "<inertial> stands 2 times, expected it once");
  contains(errorOf(leg(joint("knee", "revolute", "base", "shank", "<axi xyz=\"0 0 1\"/>"))),
           "r.urdf: joint 'knee': element <axi>, expected one of 'parent'");
  contains(errorOf(leg(joint("knee", "revolute", "base", "shank", "<axis xzy=\"0 0 1\"/>"))),
           "joint 'knee': <axis>: attribute 'xzy', expected one of 'xyz', did you mean 'xyz'?");
}

TEST_CASE("what urdfdom complains of is refused, and other programs' elements and links aside are not") {
  contains(errorOf(leg(joint("knee", "revolute", "base", "shank"),
                       link("shank", inertial("3", "0.1") +
                                         "<visual><geometry><box size=\"1\"/></geometry></visual>"))),
           "r.urdf: cannot be read in full (");
  CHECK(errorOf(leg(joint("knee", "revolute", "base", "shank",
                          "<axis xyz=\"0 0 1\"/><gazebo><kp>1</kp></gazebo><drake:gear_ratio value=\"3\"/>"),
                    link("shank", inertial("3", "0.1") + "<contact><stiffness value=\"1\"/></contact>"))) ==
        kNothing);
  CHECK(errorOf(robot(link("base") + link("shank", inertial("3", "0.1")) + link("horn", "<camera/>") +
                      joint("knee", "revolute", "base", "shank") + joint("branch", "fixed", "base", "horn")),
                "base", "shank") == kNothing);
}

TEST_CASE("links that no body could be are refused where a joint moves them, and taken where none does") {
  contains(
      errorOf(leg(joint("knee", "revolute", "base", "shank"), link("shank", inertial("0", "0.1")))),
      "r.urdf: from 'base' to 'foot': link 1 'shank': mass_kg = 0, expected more than 0 with an inertia");
  const std::string plate =
      "<inertial><mass value=\"3\"/><inertia ixx=\"0.1\" iyy=\"0.1\" izz=\"0.3\" ixy=\"0\" ixz=\"0\" "
      "iyz=\"0\"/>"
      "</inertial>";
  contains(errorOf(leg(joint("knee", "revolute", "base", "shank"), link("shank", plate))),
           "link 1 'shank': inertia_kg_m2: largest principal moment = 0.3, expected at most the sum of the "
           "other two");
  const std::string on_nothing =
      robot(link("root", inertial("0", "0.1")) + link("base", inertial("0", "1")) +
            link("shank", inertial("3", "0.1")) + joint("weld", "fixed", "root", "base") +
            joint("knee", "revolute", "base", "shank"));
  CHECK(parseUrdfChain(on_nothing, "r.urdf", "root", "shank").size() == 2);
}

TEST_CASE("a model file names a URDF, and is written link by link with the same numbers") {
  const ScratchFolder folder;
  writeFile(folder / "r.urdf", leg());
  writeFile(folder / "model.toml",
            "[mechanism]\nkind = \"serial_chain\"\ngravity_m_s2 = [0, -9.81, 0]\nurdf = \"r.urdf\"\nbase = "
            "\"base\"\ntip = \"foot\"\n[[effect]]\nkind = \"viscous_friction\"\njoint = "
            "1\ncoefficient_Nms_rad = 0.3\n");
  const model::ModelDescription description = loadModel(folder / "model.toml");
  CHECK(description.joints() == 1);
  const model::DynamicsModel dynamics = makeModel(description);
  CHECK(dynamics.mechanism().inertia(JointVector::Zero(1))(0, 0) == doctest::Approx(0.1));
  const std::string text = modelText(description);
  const model::ModelDescription reread = parseModel(text, "model.toml");
  CHECK(modelText(reread) == text);
  CHECK(modelText(describeModel(makeModel(reread))) == text);
}

TEST_CASE("each chain of a model on one base may be of a URDF, or link by link") {
  const ScratchFolder folder;
  writeFile(folder / "legs.urdf", leg());
  const auto parsed = [&](const std::string& lines) {
    return parseModel("[mechanism]\nkind = \"serial_chain\"\ngravity_m_s2 = [0, 0, -9]\n" + lines,
                      (folder / "model.toml").string());
  };
  const std::string of_urdf = "[[mechanism.chain]]\nurdf = \"legs.urdf\"\nbase = \"base\"\ntip = \"foot\"\n";
  const std::string of_links =
      "[[mechanism.chain]]\n[[mechanism.chain.link]]\nname = \"arm\"\njoint = \"revolute\"\n"
      "inertia_kg_m2 = [0.1, 0.1, 0.1, 0, 0, 0]\nmass_kg = 1\n";
  const model::ModelDescription description = parsed(of_urdf + of_links);
  const auto& group = std::get<model::ChainGroupParameters>(description.mechanism);
  REQUIRE(group.chains.size() == 2);
  CHECK(group.chains[0].links.back().name == "foot");
  CHECK(group.chains[1].links[0].name == "arm");
  CHECK(group.chains[1].gravity_m_s2.z() == -9.0);
  CHECK(description.joints() == group.chains[0].joints() + 1);

  const auto refused = [&](const std::string& lines) { return messageOf<FileError>([&] { parsed(lines); }); };
  contains(refused("urdf = \"legs.urdf\"\n" + of_urdf),
           "key 'mechanism.urdf': stands beside 'chain', expected it within a table [[mechanism.chain]]");
  contains(refused("[[mechanism.chain]]\n"),
           "key 'mechanism.chain[1].link': missing, expected a table [[mechanism.chain.link]] for each link");
  contains(refused(of_urdf + "gravity_m_s2 = [0, 0, 0]\n"), "mechanism.chain[1].gravity_m_s2");
  contains(refused(of_links + of_links + "mass_kg = -1\n"), "mass_kg");
  contains(refused("chain = 3\n"), "key 'mechanism.chain'");
}

TEST_CASE("a link of any name survives writing and reading") {
  model::SerialChainParameters chain;
  chain.links = parseUrdfChain(leg(), "r.urdf", "base", "foot");
  chain.links[0].name = "a \"b\" \\ c\n\t\x7F Öse";
  const model::ModelDescription reread =
      parseModel(modelText({.mechanism = chain, .effects = {}}), "model.toml");
  CHECK(std::get<model::SerialChainParameters>(reread.mechanism).links[0].name == chain.links[0].name);
}

TEST_CASE("a chain in a model file is refused by key, value and expectation") {
  const auto refused = [](const std::string& lines) {
    return messageOf<FileError>(
        [&] { parseModel("[mechanism]\nkind = \"serial_chain\"\n" + lines, "model.toml"); });
  };
  contains(refused(""), "model.toml:1: key 'mechanism.link': missing, expected a table [[mechanism.link]]");
  contains(refused("[[mechanism.link]]\nname = \"a\"\njoint = \"ball\""),
           "key 'mechanism.link[1].joint': value 'ball', expected one of 'fixed', 'revolute', 'prismatic'");
  contains(refused("[[mechanism.link]]\nname = \"a\"\njoint = \"revolute\"\nmass_kg = -1"),
           "key 'mechanism.link[1].mass_kg': value -1, expected a number in [0, 1000]");
  contains(refused("[[mechanism.link]]\nname = \"a\"\njoint = \"fixed\"\naxis = [0, 0, 1]"), "axis");
  contains(refused("urdf = \"r.urdf\"\nbase = \"a\"\ntip = \"b\"\n[[mechanism.link]]\nname = \"a\""),
           "stands beside 'urdf', which has the links; expected one of the two");
  contains(refused("[[mechanism.link]]\nname = \"a\"\njoint = \"revolute\""),
           "model.toml:3: key 'mechanism.link': serial_chain: inertia that joint 1 moves, with those after "
           "it free = 0, expected "
           "more than 0");
  contains(
      refused("[[mechanism.link]]\nname = \"a\"\njoint = \"revolute\"\nmass_kg = 0\ninertia_kg_m2 = [1, 1, "
              "1, 0, 0, 0]"),
      "model.toml:6: key 'mechanism.link[1].mass_kg': mass_kg = 0, expected more than 0 with an inertia");
  contains(refused("urdf = \"no.urdf\"\nbase = \"a\"\ntip = \"b\""), "no.urdf");
}
