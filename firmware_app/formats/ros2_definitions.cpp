#include "firmware_app/formats/ros2_definitions.hpp"

namespace patella::formats {
namespace {

std::string part(const std::string& name, const std::string& definition) {
  return std::string(80, '=') + "\nMSG: " + name + "\n" + definition;
}

std::string time() {
  return part("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n");
}

std::string header() {
  return part("std_msgs/Header", "builtin_interfaces/Time stamp\nstring frame_id\n") + time();
}

}  // namespace

std::string jointStateDefinition() {
  return "std_msgs/Header header\n"
         "string[] name\n"
         "float64[] position\n"
         "float64[] velocity\n"
         "float64[] effort\n" +
         header();
}

std::string canFrameDefinition() {
  return "std_msgs/Header header\n"
         "uint32 id\n"
         "bool is_rtr\n"
         "bool is_extended\n"
         "bool is_error\n"
         "uint8 dlc\n"
         "uint8[8] data\n" +
         header();
}

std::string canFdFrameDefinition() {
  return "std_msgs/Header header\n"
         "uint32 id\n"
         "bool is_extended\n"
         "bool is_error\n"
         "bool bit_rate_switch\n"
         "uint8[] data\n" +
         header();
}

std::string logDefinition() {
  return "byte DEBUG=10\n"
         "byte INFO=20\n"
         "byte WARN=30\n"
         "byte ERROR=40\n"
         "byte FATAL=50\n"
         "builtin_interfaces/Time stamp\n"
         "uint8 level\n"
         "string name\n"
         "string msg\n"
         "string file\n"
         "string function\n"
         "uint32 line\n" +
         time();
}

std::string timingDefinition() {
  return "# What the ticks of a second took, and what the bus carried.\n"
         "float64 t_s  # its beginning, of the loop's time\n"
         "uint32 ticks\n"
         "uint32 missed_periods\n"
         "uint32 frames\n"
         "uint32 frame_bits  # without stuff bits\n"
         "float64 wakeup_p50_us\n"
         "float64 wakeup_p99_us\n"
         "float64 wakeup_p99_9_us\n"
         "float64 wakeup_max_us\n"
         "float64 execution_p50_us\n"
         "float64 execution_p99_us\n"
         "float64 execution_p99_9_us\n"
         "float64 execution_max_us\n"
         "# Histograms: the upper ends of the buckets that hold something, and how many ticks each holds.\n"
         "float64[] wakeup_bucket_us\n"
         "uint32[] wakeup_count\n"
         "float64[] execution_bucket_us\n"
         "uint32[] execution_count\n";
}

}  // namespace patella::formats
