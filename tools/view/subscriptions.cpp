#include "tools/view/subscriptions.hpp"

#include <limits>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "firmware_app/files/json_file.hpp"
#include "firmware_app/formats/little_endian.hpp"

namespace patella::view {
namespace {

// The protocol's uint32: other numbers would be taken for one that nobody gave.
std::uint32_t idOf(const nlohmann::json& value) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > std::numeric_limits<std::uint32_t>::max()) {
    throw std::invalid_argument("id " + value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace) +
                                ", expected a whole number from 0 to 4294967295");
  }
  return value.get<std::uint32_t>();
}

}  // namespace

std::string Subscriptions::obey(std::string_view message) {
  std::string complaint;
  try {
    const nlohmann::json request = app::parseJson(message, "request");
    const auto operation = request.at("op").get<std::string>();
    if (operation == "subscribe") {
      for (const auto& subscription : request.at("subscriptions")) {
        const std::uint32_t id = idOf(subscription.at("id"));
        const std::uint32_t channel = idOf(subscription.at("channelId"));
        if (channel >= channels_ || channel_of_.size() >= kMost) {
          complaint = "no such channel, or too many subscriptions";
        } else {
          channel_of_[id] = static_cast<std::uint16_t>(channel);
        }
      }
    } else if (operation == "unsubscribe") {
      for (const auto& id : request.at("subscriptionIds")) {
        channel_of_.erase(idOf(id));
      }
    } else {
      complaint =
          "operation '" + operation.substr(0, 40) + "' is not served: this server has no capabilities";
    }
  } catch (const std::exception& error) {
    complaint = std::string("not understood: ") + error.what();
  }
  return complaint;
}

std::string messageData(std::uint32_t subscription, std::uint64_t time_ns, std::string_view message) {
  constexpr std::uint8_t kMessageData = 1;
  std::string bytes;
  bytes.reserve(sizeof kMessageData + sizeof subscription + sizeof time_ns + message.size());
  formats::appendNumber(bytes, kMessageData);
  formats::appendNumber(bytes, subscription);
  formats::appendNumber(bytes, time_ns);
  bytes.append(message);
  return bytes;
}

}  // namespace patella::view
