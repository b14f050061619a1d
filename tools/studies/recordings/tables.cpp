#include "tools/studies/recordings/tables.hpp"

#include <algorithm>

#include <spdlog/fmt/fmt.h>

namespace patella::study {

using namespace offline;
namespace {

constexpr double kMilli = 1e3;

Samples leads(const EmgStudy& study) {
  Samples result;
  for (const Onset& onset : study.onsets) {
    result.push_back(onset.lead_s());
  }
  return result;
}

std::string leadText(Samples values) {
  std::sort(values.begin(), values.end());
  return values.empty()
             ? fmt::format("{:>7}{:>8}{:>15}", 0, "-", "-")
             : fmt::format("{:>7}{:>8.0f}{:>15}", values.size(), kMilli * median(values),
                           fmt::format("{:.0f} to {:.0f}", kMilli * values.front(), kMilli * values.back()));
}

}  // namespace

std::string emgTable(std::span<const EmgStudy> studies) {
  std::string text =
      "Knee torque from recorded EMG, and the knee motion recorded with it (positive: EMG comes first)\n"
      "                              with knee angle     with knee rate      onset leads motion by / ms\n"
      "  person      sign  effort    corr.   lag / ms    corr.   lag / ms    moves  median          range   "
      "simulated knee, corr.\n";
  Samples all;
  for (const EmgStudy& study : studies) {
    const Samples of_person = leads(study);
    all.insert(all.end(), of_person.begin(), of_person.end());
    text +=
        fmt::format("  {:<12}{:>3}   {:<10}{:>5.2f}{:>10.0f}{:>11.2f}{:>10.0f}   {}{:>12.2f}\n", study.person,
                    study.goniometer_sign > 0 ? "+" : "-", study.flexion ? "flexion" : "extension",
                    study.angle.correlation, kMilli * study.angle.lag_s, study.velocity.correlation,
                    kMilli * study.velocity.lag_s, leadText(of_person), study.simulated_angle_correlation);
  }
  return text + fmt::format("  {:<64}{}\n", "all", leadText(all)) +
         "  Onset: more than rest by 3 deviations, not below for over 50 ms (Hodges and Bui 1996); motion by "
         "its\n"
         "  rate. The envelope's filter takes 37 ms of the lead; the goniometer gave 50 samples a second.\n"
         "  Angle is the measure of agreement: the muscles carry the shank's weight, most of it at full "
         "extension,\n"
         "  when the rate has passed its peak; so torque trails rate.\n";
}

std::string pendulumTable(std::span<const PendulumStudy> studies) {
  std::string text =
      "Torque that the rigid body does not explain: the loop's f_s, and inverse dynamics offline (N·m)\n"
      "                   as it came            delay taken out       delay / ms          RMS                "
      "  "
      "friction\n"
      "  run    joint   corr.  RMS of diff.   corr.  RMS of diff.   chain  measured   loop  offline     loop "
      " "
      "offline\n";
  for (const PendulumStudy& study : studies) {
    for (std::size_t joint = 0; joint < study.joint.size(); ++joint) {
      const JointComparison& c = study.joint[joint];
      text += fmt::format(
          "  "
          "{:<8}{:>3}{:>9.3f}{:>12.4f}{:>11.3f}{:>12.4f}{:>10.1f}{:>9.0f}{:>9.3f}{:>8.3f}{:>10.3f}{:>8.3f}\n",
          study.run, joint + 1, c.correlation_delayed, c.rms_difference_delayed_Nm, c.correlation_aligned,
          c.rms_difference_aligned_Nm, kMilli * study.delay_s, kMilli * c.measured_delay_s, c.rms_loop_Nm,
          c.rms_offline_Nm, c.friction_loop_Nm, c.friction_offline_Nm);
    }
  }
  return text;
}

}  // namespace patella::study
