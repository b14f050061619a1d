#include "tools/view/subscriptions.hpp"

#include <nlohmann/json.hpp>

#include "firmware_app/files/json_file.hpp"
#include "firmware_app/formats/little_endian.hpp"

namespace patella::view {

std::string Subscriptions::obey(std::string_view message) {
  std::string complaint;
  try {
    const nlohmann::json request = app::parseJson(message, "request");
    const auto operation = request.at("op").get<std::string>();
    if (operation == "subscribe") {
      for (const auto& subscription : request.at("subscriptions")) {
        const auto id = subscription.at("id").get<std::uint32_t>();
        const auto channel = subscription.at("channelId").get<std::uint64_t>();
        if (channel >= channels_ || channel_of_.size() >= kMost) {
          complaint = "no such channel, or too many subscriptions";
        } else {
          channel_of_[id] = static_cast<std::uint16_t>(channel);
        }
      }
    } else if (operation == "unsubscribe") {
      for (const auto& id : request.at("subscriptionIds")) {
        channel_of_.erase(id.get<std::uint32_t>());
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
