// The viewer's server with a client that sends anything: bytes in place of a request, or behind a sound
// upgrade frames of the WebSocket protocol, broken ones and whole ones. The first byte chooses. Whatever
// comes, the server still serves the next.
#include <array>
#include <string>
#include <string_view>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <sys/socket.h>
#include <unistd.h>

#include "firmware_app/live/live_ring.hpp"
#include "firmware_app/live/live_run.hpp"
#include "tests/fuzz/fuzz_input.hpp"
#include "tools/view/server.hpp"
#include "tools/view/subscriptions.hpp"

namespace {

using namespace patella;
using boost::asio::ip::tcp;

constexpr std::size_t kMostFrame = 125;  // of one byte of length

/// A live run of a few columns, and a server on a port of its own.
struct Stage {
  std::filesystem::path folder = "/patella-fuzz-" + std::to_string(getpid());
  live::LiveRun run{folder, {"t_s", "q1_rad", "state"}};
  live::RingReader ring{live::ringName(folder)};
  boost::asio::io_context context;
  view::Server server{context, {.port = 0, .access = {}, .name = "fuzz"}, {.ring = &ring}};
  double time_s = 0.0;

  Stage() { server.start(); }
  void tick() {
    time_s += 1e-3;
    const std::array<double, 3> row = {time_s, -1.0, 2.0};
    run.tick(row, {.wall_ns = 1, .loop_ns = 1});
  }
};

std::string host(const Stage& stage) {
  return "127.0.0.1:" + std::to_string(stage.server.port());
}

std::string upgrade(const Stage& stage) {
  return "GET / HTTP/1.1\r\nHost: " + host(stage) +
         "\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
         "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\nSec-WebSocket-Protocol: foxglove.sdk.v1\r\n\r\n";
}

/// Lines as text messages, masked with zeros: as they are.
std::string asFrames(std::string_view lines) {
  std::string frames;
  while (!lines.empty()) {
    const std::string_view line = lines.substr(0, lines.find('\n'));
    const std::string_view part = line.substr(0, kMostFrame);
    frames += '\x81';
    frames += static_cast<char>(0x80U | part.size());
    frames.append(4, '\0');
    frames += part;
    lines.remove_prefix(std::min(line.size() + 1, lines.size()));
  }
  return frames;
}

std::string sent(const Stage& stage, std::string_view input) {
  const unsigned kind = input.empty() ? 0U : static_cast<unsigned char>(input.front()) % 4U;
  input.remove_prefix(input.empty() ? 0 : 1);
  switch (kind) {
    case 0:
      return std::string(input);
    case 1:
      return "GET /" + std::string(input) + " HTTP/1.1\r\nHost: " + host(stage) + "\r\n\r\n";
    case 2:
      return upgrade(stage) + std::string(input);
    default:
      return upgrade(stage) + asFrames(input);
  }
}

void poll(Stage& stage) {
  for (int round = 0; round < 8; ++round) {
    stage.tick();
    stage.context.poll();
  }
}

/// What a client that sends these bytes is answered.
std::string answer(Stage& stage, const std::string& bytes) {
  boost::asio::io_context own;
  tcp::socket socket(own);
  boost::system::error_code error;
  do {  // the port that the system chose may be taken, and the fuzzer's own clock interrupts
    socket = tcp::socket(own);
    error.clear();
    socket.connect({boost::asio::ip::address_v4::loopback(), stage.server.port()}, error);
  } while (error == boost::asio::error::address_in_use || error == boost::asio::error::interrupted ||
           error == boost::system::errc::address_not_available);
  fuzz::require(!error, ("the server can be reached: " + error.message()).c_str());
  // No port waits for stragglers afterwards: there are thousands of connections a second.
  socket.set_option(boost::asio::socket_base::linger(true, 0));
  socket.non_blocking(true);
  boost::asio::write(socket, boost::asio::buffer(bytes), error);
  poll(stage);
  std::string received(4096, '\0');
  received.resize(socket.read_some(boost::asio::buffer(received), error));
  socket.close(error);
  poll(stage);
  return received;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static Stage stage;
  view::Subscriptions subscriptions(formats::kRunChannels);
  subscriptions.obey(fuzz::text(data, size));
  fuzz::require(subscriptions.all().size() <= view::Subscriptions::kMost, "subscriptions are bounded");
  for (const auto& [id, channel] : subscriptions.all()) {
    fuzz::require(channel < formats::kRunChannels, "a subscription is of a channel that there is");
  }
  answer(stage, sent(stage, fuzz::text(data, size)));
  fuzz::require(
      answer(stage, "GET / HTTP/1.1\r\nHost: " + host(stage) + "\r\n\r\n").starts_with("HTTP/1.1 200"),
      "the next client is served");
  return 0;
}
