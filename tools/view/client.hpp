// One connected viewer: the WebSocket subprotocols foxglove.websocket.v1 and foxglove.sdk.v1, as far as a
// server needs them that only shows (https://github.com/foxglove/ws-protocol).
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <boost/beast/core.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket.hpp>

#include "firmware_app/formats/run_messages.hpp"
#include "tools/view/batched_stream.hpp"
#include "tools/view/subscriptions.hpp"

namespace patella::view {

using Request = boost::beast::http::request<boost::beast::http::empty_body>;

/// What all clients are told when they connect.
struct Catalogue {
  std::string server_info;  ///< JSON
  std::string advertise;    ///< JSON
  std::size_t channels = 0;
};

/// Text with the channels of a run.
Catalogue catalogueOf(const std::string& name, const std::vector<formats::ChannelDescription>& channels);

/// The first of a request's subprotocols that is served; empty where there is none.
std::string subprotocolOf(const Request& request);

class Client : public std::enable_shared_from_this<Client> {
 public:
  Client(boost::beast::tcp_stream&& stream, const Catalogue& catalogue);

  /// Answers the upgrade, and then lives as long as the connection.
  void start(const Request& request, const std::string& subprotocol);
  /// Sends a message to a client that has subscribed to its channel. A client that is slow loses its oldest
  /// messages.
  void send(std::uint16_t channel, std::uint64_t time_ns, std::string_view message);
  /// Tells the client that nothing more will come.
  void end();
  bool open() const noexcept { return open_; }
  std::uint64_t dropped() const noexcept { return dropped_; }

 private:
  enum class Level { kInfo = 0, kWarning = 1 };  // of a status, as in the protocol
  struct Outgoing {
    std::string bytes;
    bool text = false;
  };

  void read();
  void complain(const std::string& words);
  void tell(std::string text);
  void tellStatus(Level level, const std::string& words);
  void queue(Outgoing&& outgoing);
  void startWriting();
  void write();
  void fail() noexcept;

  boost::beast::websocket::stream<BatchedStream> socket_;
  const Catalogue& catalogue_;
  boost::beast::flat_buffer incoming_;
  Subscriptions subscriptions_;
  std::deque<Outgoing> outgoing_;  ///< the first is being written
  std::size_t queued_bytes_ = 0;
  std::uint64_t dropped_ = 0;
  std::uint64_t dropped_told_ = 0;
  bool writing_ = false;
  bool open_ = false;
};

}  // namespace patella::view
