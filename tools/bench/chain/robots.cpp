#include "tools/bench/chain/robots.hpp"

#include <array>
#include <stdexcept>
#include <utility>

#include "firmware_app/files/atomic_file.hpp"

namespace patella::bench {
namespace {

struct Repair {
  const char* file;
  const char* wrong;
  const char* right;
};

// The tensors break the triangle inequality by 0.7 and 13.5 %; a moment was raised to what a thin plate has.
constexpr std::array kRepairs{
    Repair{"double_pendulum.urdf", "<joint name=\"base_weld\"",
           "<link name=\"world\"/><joint name=\"base_weld\""},
    Repair{"ufactory_xarm6.urdf",
           "ixx=\"0.0248674\" ixy=\"-0.00430651\" ixz=\"-0.00067797\" iyy=\"0.00485548\"",
           "ixx=\"0.0258674\" ixy=\"-0.00430651\" ixz=\"-0.00067797\" iyy=\"0.00585548\""},
    Repair{"ufactory_xarm6.urdf", "ixx=\"0.0053694\" ixy=\"0.0014185\" ixz=\"-0.00092094\" iyy=\"0.0032423\"",
           "ixx=\"0.0073694\" ixy=\"0.0014185\" ixz=\"-0.00092094\" iyy=\"0.0052423\""}};

}  // namespace

const std::vector<Robot>& robots() {
  static const std::vector<Robot> all{
      {"cart and pole", "cartpole.urdf", "slideBar", "pole"},
      {"double pendulum", "double_pendulum.urdf", "world", "Weight"},
      {"UR5", "ur5.urdf", "world", "tool0"},
      {"xArm 6", "ufactory_xarm6.urdf", "world", "link6"},
      {"G1, left leg", "unitree_g1_12dof.urdf", "pelvis", "left_ankle_roll_link"},
      {"G1, right leg", "unitree_g1_12dof.urdf", "pelvis", "right_ankle_roll_link"},
      {"iiwa", "kuka_iiwa.urdf", "lbr_iiwa_link_0", "lbr_iiwa_link_7"},
      {"Gen3", "kinova_gen3_7dof.urdf", "base_link", "end_effector_link"},
      {"Panda", "franka_panda.urdf", "panda_link0", "panda_hand_tcp"},
      {"Panda, finger", "franka_panda.urdf", "panda_link0", "panda_leftfinger"}};
  return all;
}

std::string urdfText(const std::filesystem::path& folder, const Robot& robot) {
  std::string text = app::readFile(folder / robot.file);
  for (const Repair& repair : kRepairs) {
    const std::string wrong = repair.wrong;
    if (robot.file != repair.file) {
      continue;
    }
    const std::size_t at = text.find(wrong);
    if (at == std::string::npos) {
      throw std::runtime_error((folder / robot.file).string() + ": has no '" + wrong +
                               "', which is to be repaired");
    }
    text.replace(at, wrong.size(), repair.right);
  }
  return text;
}

}  // namespace patella::bench
