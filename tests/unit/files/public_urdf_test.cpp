// Public URDF files as they are: which are taken, and which are refused in which words.
#include <filesystem>
#include <string>

#include <doctest/doctest.h>

#include "core/model/serial_chain.hpp"
#include "firmware_app/files/urdf_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::app;

namespace {

const std::filesystem::path kFolder = checkout::recordings() / "urdf";

model::SerialChain chainOf(const std::string& file, const std::string& base, const std::string& tip) {
  return model::SerialChain({.links = loadUrdfChain(kFolder / file, base, tip)});
}

void refuses(const std::string& file, const std::string& base, const std::string& tip,
             const std::string& words) {
  const std::string message = test::messageOf<FileError>([&] { loadUrdfChain(kFolder / file, base, tip); });
  CAPTURE(message);
  CHECK(message.find(file) != std::string::npos);
  CHECK(message.find(words) != std::string::npos);
}

}  // namespace

TEST_CASE("arms and legs are taken, with frames at their ends and roots that weigh nothing") {
  CHECK(chainOf("ur5.urdf", "world", "ee_link").joints() == 6);
  CHECK(chainOf("kinova_gen3_7dof.urdf", "base_link", "end_effector_link").joints() == 7);
  CHECK(chainOf("kuka_iiwa.urdf", "lbr_iiwa_link_0", "lbr_iiwa_link_7").joints() == 7);
  CHECK(chainOf("franka_panda.urdf", "panda_link0", "panda_leftfinger").joints() == 8);
  CHECK(chainOf("cartpole.urdf", "slideBar", "pole").joints() == 2);
  CHECK(chainOf("unitree_g1_12dof.urdf", "pelvis", "left_ankle_roll_link").joints() == 6);
  CHECK(chainOf("unitree_g1_12dof.urdf", "pelvis", "right_knee_link").joints() == 4);
}

// Arms of six and seven revolute joints, the first along gravity: Khalil and Dombre, Section 9.4, for six;
// Gaz and others, Dynamic identification of the Franka Emika Panda robot, 2019, for seven.
TEST_CASE("an upright arm of six joints has 36 base parameters, one of seven has 43") {
  CHECK(chainOf("ur5.urdf", "world", "tool0").baseParameterCount() == 36);
  CHECK(chainOf("franka_panda.urdf", "panda_link0", "panda_hand_tcp").baseParameterCount() == 43);
  CHECK(chainOf("kuka_iiwa.urdf", "lbr_iiwa_link_0", "lbr_iiwa_link_7").baseParameterCount() == 43);
}

TEST_CASE("files that contradict themselves or physics are refused by link or joint") {
  refuses("ufactory_xarm6.urdf", "world", "link6",
          "link 3 'link2': inertia_kg_m2: largest principal moment = 0.02689");
  refuses("ufactory_xarm6.urdf", "link2", "link6", "'link3': inertia_kg_m2: largest principal moment");
  refuses("double_pendulum.urdf", "base_link", "Weight", "world");
  refuses("franka_panda.urdf", "panda_link0", "panda_rightfinger",
          "joint 'panda_finger_joint2' mimics joint 'panda_finger_joint1'");
  refuses("unitree_g1_12dof.urdf", "world", "pelvis",
          "base 'world' is no link of it, expected one of 'd435_link'");
  refuses("unitree_g1_12dof.urdf", "left_knee_link", "right_knee_link",
          "is not beyond base 'left_knee_link'");
  refuses("ur5.urdf", "world", "tool1", "expected one of 'base', 'base_link', 'ee_link'");
  refuses("no_such.urdf", "a", "b", "no_such.urdf");
  refuses("README.md", "a", "b", "is no URDF");
}
