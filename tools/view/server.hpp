// One port: the page for browsers, a WebSocket for viewers of a live run. It takes no commands.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/steady_timer.hpp>

#include "firmware_app/live/live_ring.hpp"
#include "tools/view/access.hpp"
#include "tools/view/client.hpp"
#include "tools/view/recording.hpp"

namespace patella::view {

struct ServerOptions {
  std::string address = "127.0.0.1";
  std::uint16_t port = 8765;  ///< 0: any that is free
  Access access;              ///< its hosts are filled in by the server
  std::string name;           ///< that viewers show
};

/// A live run, or one that has ended: one of the two.
struct Shown {
  live::RingReader* ring = nullptr;
  const Recording* recording = nullptr;
};

class Server {
 public:
  static constexpr std::size_t kMostClients = 8;

  /// Listens. Throws std::runtime_error where it cannot.
  Server(boost::asio::io_context& context, const ServerOptions& options, const Shown& shown);
  /// Serves until the live run has ended, or the context is stopped.
  void start();
  std::uint16_t port() const;

 private:
  struct Visit;

  void accept();
  void answer(const std::shared_ptr<Visit>& visit);
  void pump();
  std::size_t openClients();

  boost::asio::io_context& context_;
  Access access_;
  Shown shown_;
  Catalogue catalogue_;
  boost::asio::ip::tcp::acceptor acceptor_;
  boost::asio::steady_timer timer_;
  std::vector<std::shared_ptr<Client>> clients_;
  std::size_t visits_ = 0;  ///< requests that are being read or answered
};

}  // namespace patella::view
