// What a client has asked for, by the messages of the Foxglove WebSocket protocol that a client may send
// (https://github.com/foxglove/ws-protocol).
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>

namespace patella::view {

class Subscriptions {
 public:
  /// More of them are refused.
  static constexpr std::size_t kMost = 64;

  explicit Subscriptions(std::size_t channels) : channels_(channels) {}

  /// Obeys a message. Returns in words why it could not, or not all of it; nothing where it could.
  std::string obey(std::string_view message);

  /// Identifier that the client chose -> channel.
  const std::map<std::uint32_t, std::uint16_t>& all() const noexcept { return channel_of_; }

 private:
  std::size_t channels_;
  std::map<std::uint32_t, std::uint16_t> channel_of_;
};

/// A message on a channel, as the protocol frames it.
std::string messageData(std::uint32_t subscription, std::uint64_t time_ns, std::string_view message);

}  // namespace patella::view
