#include "drivers/can/input_table.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <string>
#include <system_error>

#include "core/types.hpp"
#include "drivers/joined.hpp"

namespace patella::can {

InputId inputOf(std::string_view name, int joints) {
  const std::string quoted = "input '" + std::string(name) + "'";
  const std::size_t dot = std::min(name.find('.'), name.size());
  const bool indexed = dot != name.size();
  const auto* known = std::find_if(kInputKinds.begin(), kInputKinds.end(), [&](const InputKind& candidate) {
    return candidate.name == name.substr(0, dot) && candidate.indexed == indexed;
  });
  if (known == kInputKinds.end()) {
    known = std::find_if(kInputKinds.begin(), kInputKinds.end(),
                         [&](const InputKind& candidate) { return candidate.name == name.substr(0, dot); });
  }
  if (known == kInputKinds.end()) {
    const auto text = [](const InputKind& kind) {
      return std::string(kind.name) + (kind.indexed ? ".<number>" : "");
    };
    throw std::invalid_argument(quoted + " is unknown; there are: " + joined(kInputKinds, ", ", text));
  }
  const auto input = static_cast<Input>(known - kInputKinds.begin());
  if (!known->indexed) {
    if (indexed)
      throw std::invalid_argument(quoted + " takes no number");
    return {input, 0};
  }
  const int largest = input == Input::kEmg ? kMaxEmgChannels : joints;
  const std::string_view digits = name.substr(std::min(dot + 1, name.size()));
  int number = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  if (error != std::errc() || end != digits.data() + digits.size() || number < 1 || number > largest) {
    throw std::invalid_argument(quoted + " needs a number from 1 to " + std::to_string(largest) +
                                " after the dot");
  }
  return {input, static_cast<std::size_t>(number - 1)};
}

}  // namespace patella::can
