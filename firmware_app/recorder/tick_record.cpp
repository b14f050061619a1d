#include "firmware_app/recorder/tick_record.hpp"

#include <cstddef>
#include <cstring>
#include <limits>
#include <type_traits>

namespace patella::app {
namespace {

using Getter = double (*)(const TickRecord&, int);

void perJoint(std::vector<TickColumn>& columns, int joints, const std::string& stem, const std::string& unit,
              Getter getter) {
  for (int i = 0; i < joints; ++i) {
    columns.push_back({stem + std::to_string(i + 1) + "_" + unit, getter, i});
  }
}

void single(std::vector<TickColumn>& columns, const std::string& name, Getter getter) {
  columns.push_back({name, getter, 0});
}

constexpr double kMicrosecond = 1e-3;  // in units of ns
// A column of limits has 32 bits, which is eight for each of four joints.
constexpr std::uint64_t kLow32Bits = 0xFFFFFFFFU;
constexpr int kJointsOfLimits = 4;

}  // namespace

void copyRecord(const TickRecord& from, TickRecord& to) noexcept PATELLA_NONBLOCKING {
  static_assert(std::is_trivially_copyable_v<TickRecord> && std::is_standard_layout_v<TickRecord>);
  std::memcpy(&to, &from, offsetof(TickRecord, joint) + from.joints * sizeof(JointRecord));
}

std::vector<TickColumn> tickColumns(int joints) {
  std::vector<TickColumn> c;
  using R = TickRecord;
  single(c, "t_s", [](const R& r, int) { return r.time_s; });
  perJoint(c, joints, "q", "rad", [](const R& r, int i) { return r.joint[i].q_rad; });
  perJoint(c, joints, "dq", "rad_s", [](const R& r, int i) { return r.joint[i].dq_rad_s; });
  perJoint(c, joints, "tau", "Nm", [](const R& r, int i) { return r.joint[i].drive_torque_Nm; });
  perJoint(c, joints, "tau_cmd", "Nm", [](const R& r, int i) { return r.joint[i].torque_command_Nm; });
  perJoint(c, joints, "ref", "rad", [](const R& r, int i) { return r.joint[i].reference_rad; });
  perJoint(c, joints, "dref", "rad_s", [](const R& r, int i) { return r.joint[i].reference_rad_s; });
  perJoint(c, joints, "f_s", "rad_s2", [](const R& r, int i) { return r.joint[i].f_s_rad_s2; });
  perJoint(c, joints, "f_s_filtered", "rad_s2",
           [](const R& r, int i) { return r.joint[i].f_s_filtered_rad_s2; });
  perJoint(c, joints, "f_network", "rad_s2", [](const R& r, int i) { return r.joint[i].f_network_rad_s2; });
  perJoint(c, joints, "f_true", "rad_s2", [](const R& r, int i) { return r.joint[i].f_true_rad_s2; });
  perJoint(c, joints, "d_hat", "Nm", [](const R& r, int i) { return r.joint[i].d_hat_Nm; });
  perJoint(c, joints, "tau_gravity", "Nm", [](const R& r, int i) { return r.joint[i].torque_gravity_Nm; });
  perJoint(c, joints, "tau_model", "Nm", [](const R& r, int i) { return r.joint[i].torque_model_Nm; });
  perJoint(c, joints, "tau_emg", "Nm", [](const R& r, int i) { return r.joint[i].torque_emg_Nm; });
  perJoint(c, joints, "tau_impedance", "Nm",
           [](const R& r, int i) { return r.joint[i].torque_impedance_Nm; });
  perJoint(c, joints, "tau_compensation", "Nm",
           [](const R& r, int i) { return r.joint[i].torque_compensation_Nm; });
  perJoint(c, kMaxEmgChannels, "emg", "mV", [](const R& r, int i) { return r.emg_mV[i]; });
  for (int i = 0; i < kMaxEmgChannels; ++i) {
    c.push_back({"activation" + std::to_string(i + 1), [](const R& r, int k) { return r.activation[k]; }, i});
  }
  perJoint(c, joints, "drive_temperature", "degC",
           [](const R& r, int i) { return r.joint[i].drive_temperature_degC; });
  for (int i = 0; i < joints; ++i) {
    c.push_back(
        {"drive_error" + std::to_string(i + 1), [](const R& r, int k) { return r.joint[k].drive_error; }, i});
  }
  single(c, "state", [](const R& r, int) { return static_cast<double>(r.state); });
  single(c, "faults", [](const R& r, int) { return static_cast<double>(r.faults); });
  single(c, "limits", [](const R& r, int) { return static_cast<double>(r.limits & kLow32Bits); });
  if (joints > kJointsOfLimits) {
    single(c, "limits_from_joint5", [](const R& r, int) { return static_cast<double>(r.limits >> 32U); });
  }
  single(c, "encoder_steps", [](const R& r, int) { return static_cast<double>(r.encoder_steps); });
  single(c, "missed_periods", [](const R& r, int) { return static_cast<double>(r.missed_periods); });
  single(c, "wakeup_us",
         [](const R& r, int) { return kMicrosecond * static_cast<double>(r.wakeup_latency_ns); });
  single(c, "execution_us",
         [](const R& r, int) { return kMicrosecond * static_cast<double>(r.execution_ns); });
  single(c, "latency_us", [](const R& r, int) {
    return r.sensor_latency_ns < 0 ? std::numeric_limits<double>::quiet_NaN()
                                   : kMicrosecond * static_cast<double>(r.sensor_latency_ns);
  });
  return c;
}

}  // namespace patella::app
