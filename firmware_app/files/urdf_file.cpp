#include "firmware_app/files/urdf_file.hpp"

#include <algorithm>
#include <exception>
#include <mutex>
#include <stdexcept>
#include <utility>

#include <Eigen/Geometry>
#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include "core/types.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/urdf_elements.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

using model::ChainJoint;
using model::ChainLink;

/// Keeps what urdfdom would print while it lives.
class Complaints final : public console_bridge::OutputHandler {
 public:
  Complaints() { console_bridge::useOutputHandler(this); }
  ~Complaints() override { console_bridge::restorePreviousOutputHandler(); }
  Complaints(const Complaints&) = delete;
  Complaints& operator=(const Complaints&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* /*file*/,
           int /*line*/) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR) {
      errors_ += (errors_.empty() ? "" : "; ") + text;
    }
  }
  const std::string& errors() const noexcept { return errors_; }

 private:
  std::string errors_;
};

/// `model`, whose links let go of each other at its end: links own their children in urdfdom, so that a
/// circle of them would never be freed.
urdf::ModelInterfaceSharedPtr opening(urdf::ModelInterfaceSharedPtr model) {
  urdf::ModelInterface* const links_of = model.get();
  return {links_of, [model = std::move(model)](urdf::ModelInterface* /*same*/) {
            for (const auto& [name, link] : model->links_) {
              link->child_links.clear();
              link->child_joints.clear();
            }
          }};
}

struct Parsed {
  urdf::ModelInterfaceSharedPtr robot;
  std::string errors;  // urdfdom goes on after most of them, with defaults
};

Parsed parse(std::string_view text, const std::string& name) {
  static std::mutex one_at_a_time;  // the handler is urdfdom's, not this thread's
  const std::scoped_lock lock(one_at_a_time);
  const Complaints complaints;
  std::string problem;
  urdf::ModelInterfaceSharedPtr model;
  try {
    model = urdf::parseURDF(std::string(text));
  } catch (const std::exception& error) {
    problem = error.what();
  }
  if (!model) {
    checkUrdfElements(text, name, [](const std::string&, const std::string&) { return true; });
    problem += (problem.empty() ? "" : "; ") + complaints.errors();
    throw FileError(name + ": is no URDF (" + (problem.empty() ? "no XML" : problem) +
                    "), expected <robot> with links and joints that fit together");
  }
  return {opening(std::move(model)), complaints.errors()};
}

std::string linkNames(const urdf::ModelInterface& robot) {
  std::vector<std::string> names;
  for (const auto& [link_name, link] : robot.links_) {
    names.push_back(link_name);
  }
  return quotedList(names);
}

urdf::LinkConstSharedPtr find(const urdf::ModelInterface& robot, const std::string& file, const char* role,
                              const std::string& name) {
  const urdf::LinkConstSharedPtr link = robot.getLink(name);
  if (!link) {
    throw FileError(file + ": " + role + " '" + name + "' is no link of it, expected one of " +
                    linkNames(robot));
  }
  return link;
}

/// From the one after `base` to `tip`.
std::vector<urdf::LinkConstSharedPtr> wayTo(const urdf::ModelInterface& robot, const std::string& file,
                                            const std::string& base, const std::string& tip) {
  find(robot, file, "base", base);
  std::vector<urdf::LinkConstSharedPtr> way;
  std::vector<std::string> passed;
  for (urdf::LinkConstSharedPtr link = find(robot, file, "tip", tip); link && link->name != base;
       link = link->getParent()) {
    // urdfdom takes links in a circle as long as another one is the root.
    if (way.size() == robot.links_.size()) {
      throw FileError(file + ": the links above tip '" + tip + "' are a circle, expected a tree");
    }
    way.push_back(link);
    passed.push_back(link->name);
  }
  if (way.empty() || !way.back()->getParent()) {
    throw FileError(file + ": tip '" + tip + "' is not beyond base '" + base +
                    "', expected a base of its way" +
                    (passed.empty() ? "" : " from the root: " + quotedList(passed)));
  }
  std::reverse(way.begin(), way.end());
  return way;
}

ChainJoint kindOf(const urdf::Joint& joint, const std::string& file) {
  const auto refuse = [&](const std::string& what) {
    return FileError(file + ": joint '" + joint.name + "' " + what +
                     ", expected fixed, revolute, continuous or prismatic joints between base and tip");
  };
  if (joint.mimic) {
    throw refuse("mimics joint '" + joint.mimic->joint_name + "'");
  }
  switch (joint.type) {
    case urdf::Joint::FIXED:
      return ChainJoint::kFixed;
    case urdf::Joint::REVOLUTE:
    case urdf::Joint::CONTINUOUS:
      return ChainJoint::kRevolute;
    case urdf::Joint::PRISMATIC:
      return ChainJoint::kPrismatic;
    case urdf::Joint::FLOATING:
      throw refuse("is floating");
    case urdf::Joint::PLANAR:
      throw refuse("is planar");
    default:
      throw refuse("has no known type");
  }
}

Eigen::Vector3d vectorOf(const urdf::Vector3& v) {
  return {v.x, v.y, v.z};
}

Eigen::Matrix3d rotationOf(const urdf::Rotation& r) {
  return Eigen::Quaterniond(r.w, r.x, r.y, r.z).normalized().toRotationMatrix();
}

void setBody(ChainLink& link, const urdf::Inertial& body) {
  const Eigen::Matrix3d axes = rotationOf(body.origin.rotation);
  Eigen::Matrix3d inertia;
  inertia << body.ixx, body.ixy, body.ixz, body.ixy, body.iyy, body.iyz, body.ixz, body.iyz, body.izz;
  if (!axes.isIdentity(0.0)) {
    inertia = (axes * inertia * axes.transpose()).eval();
  }
  link.mass_kg = body.mass;
  link.com_m = vectorOf(body.origin.position);
  link.inertia_kg_m2 = {inertia(0, 0), inertia(1, 1), inertia(2, 2),
                        inertia(0, 1), inertia(0, 2), inertia(1, 2)};
}

ChainLink linkOf(const urdf::Link& from, const std::string& file) {
  const urdf::Joint& joint = *from.parent_joint;
  ChainLink link;
  link.name = from.name;
  link.joint = kindOf(joint, file);
  link.origin_m = vectorOf(joint.parent_to_joint_origin_transform.position);
  link.turn_rad = model::turnOf(rotationOf(joint.parent_to_joint_origin_transform.rotation));
  if (link.joint != ChainJoint::kFixed) {
    link.axis = vectorOf(joint.axis);
    if (!(link.axis.norm() > 0.0)) {
      throw FileError(file + ": joint '" + joint.name + "': axis 0 0 0, expected a direction");
    }
    link.axis.normalize();
  }
  if (from.inertial) {
    setBody(link, *from.inertial);
  }
  return link;
}

/// The links and joints of `way` say what they are meant to say, and urdfdom has read all of the file.
void checkAsWritten(std::string_view text, const std::string& name,
                    const std::vector<urdf::LinkConstSharedPtr>& way, const std::string& errors) {
  checkUrdfElements(text, name, [&](const std::string& element, const std::string& of) {
    return std::ranges::any_of(way, [&](const urdf::LinkConstSharedPtr& link) {
      return (element == "link" ? link->name : link->parent_joint->name) == of;
    });
  });
  if (!errors.empty()) {
    throw FileError(name + ": cannot be read in full (" + errors +
                    "), expected links and joints as the URDF format has them");
  }
}

}  // namespace

std::vector<ChainLink> loadUrdfChain(const std::filesystem::path& path, const std::string& base,
                                     const std::string& tip) {
  return parseUrdfChain(readFile(path), path.string(), base, tip);
}

std::vector<ChainLink> parseUrdfChain(std::string_view text, const std::string& name, const std::string& base,
                                      const std::string& tip) {
  const Parsed parsed = parse(text, name);
  const std::vector<urdf::LinkConstSharedPtr> way = wayTo(*parsed.robot, name, base, tip);
  checkAsWritten(text, name, way, parsed.errors);
  model::SerialChainParameters chain;
  for (const urdf::LinkConstSharedPtr& link : way) {
    chain.links.push_back(linkOf(*link, name));
  }
  try {
    model::checked(chain);
  } catch (const std::invalid_argument& error) {
    throw FileError(name + ": from '" + base + "' to '" + tip + "': " + error.what());
  }
  return chain.links;
}

}  // namespace patella::app
