#include "tests/integration/diagnose/diagnose_process.hpp"

#include <cmath>

#include <fmt/format.h>

#include "tools/checkout/checkout.hpp"

namespace patella::test {
namespace {

constexpr double kInertia_kg_m2 = 0.35;
constexpr double kMoment_kg_m = 1.0;
constexpr double kGravity_m_s2 = 9.81;

}  // namespace

Outcome diagnose(const std::vector<std::string>& arguments) {
  return runProgram(checkout::build() / "tools/diagnose/patella-diagnose", arguments);
}

std::string kneeCsv(double loss_Nm, double duration_s, double start_s) {
  std::string text = "t_s,q1_rad,tau1_Nm\n";
  constexpr double kRate_Hz = 500.0;
  // The motion is given; the torque that it takes is what the drive held on average over each step.
  const auto angle = [](double t) { return -1.2 + 0.5 * std::sin(2.1 * t) + 0.25 * std::sin(5.3 * t + 1.0); };
  const auto rate = [](double t) { return 1.05 * std::cos(2.1 * t) + 1.325 * std::cos(5.3 * t + 1.0); };
  const auto slope = [](double t) { return -2.205 * std::sin(2.1 * t) - 7.0225 * std::sin(5.3 * t + 1.0); };
  double wobble = 0.0;
  unsigned state = 1;
  for (int i = 0; i < static_cast<int>(duration_s * kRate_Hz); ++i) {
    const double t = i / kRate_Hz;
    state = 1664525U * state + 1013904223U;
    wobble = 0.98 * wobble + 0.02 * (static_cast<double>(state) * 0x1p-32 - 0.5);
    const double middle = t + 0.5 / kRate_Hz;
    const double torque = kInertia_kg_m2 * slope(middle) +
                          kMoment_kg_m * kGravity_m_s2 * std::cos(angle(middle)) +
                          loss_Nm * std::tanh(rate(middle) / 0.02) + wobble;
    text += fmt::format("{:.4f},{:.7f},{:.6f}\n", start_s + t, angle(t), torque);
  }
  return text;
}

std::string kneeModel() {
  return fmt::format(
      "[mechanism]\nkind = \"revolute\"\ninertia_kg_m2 = {}\nmoment_kg_m = {}\nlength_m = 0.4\ngravity_m_s2 "
      "= {}\n",
      kInertia_kg_m2, kMoment_kg_m, kGravity_m_s2);
}

}  // namespace patella::test
