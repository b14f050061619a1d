#include "drivers/can/named_binding.hpp"

#include <array>
#include <charconv>
#include <stdexcept>

#include "core/types.hpp"

namespace patella::can {

std::string digits(double value) {
  std::array<char, 32> text{};
  return {text.data(),
          std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::general, 6).ptr};
}

void refuse(const std::string& origin, const std::string& problem) {
  throw std::invalid_argument((origin.empty() ? "" : origin + ": ") + problem);
}

const Signal* NamedBinding::find(const Database& database) const {
  const Message* found = database.find(message);
  return found == nullptr ? nullptr : found->find(binding.signal);
}

std::optional<std::size_t> torqueJoint(const std::string& output) {
  for (std::size_t joint = 0; joint < kMaxJoints; ++joint) {
    if (output == "torque_Nm." + std::to_string(joint + 1))
      return joint;
  }
  return std::nullopt;
}

Dimension dimensionOfOutput(const std::string& output) {
  return output.starts_with("torque_Nm.") ? Dimension::kTorque : Dimension::kNone;
}

}  // namespace patella::can
