// Definitions of the messages that a run is made of, in ROS 2's language ("ros2msg"): the type itself, then
// each type that it uses behind a line of 80 '=' and "MSG: name".
#pragma once

#include <string>

namespace patella::formats {

/// sensor_msgs/msg/JointState.
std::string jointStateDefinition();
/// can_msgs/msg/Frame of ros_canopen: one classic frame.
std::string canFrameDefinition();
/// patella_msgs/msg/CanFdFrame: one CAN FD frame, for which ROS 2 has no usual type.
std::string canFdFrameDefinition();
/// rcl_interfaces/msg/Log: a line of events.log.
std::string logDefinition();
/// patella_msgs/msg/Timing: what the ticks of a second took.
std::string timingDefinition();

}  // namespace patella::formats
