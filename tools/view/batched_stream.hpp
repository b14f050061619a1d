// A TCP stream below a WebSocket, which gathers the bytes of many messages for one write to the socket. A
// run sends thousands of small messages a second to each client, and a system call for each would cost more
// than the messages.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include <boost/asio/async_result.hpp>
#include <boost/asio/error.hpp>
#include <boost/asio/post.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket/teardown.hpp>

namespace patella::view {

/// An AsyncStream of Boost.Beast. Bytes that are written leave at once, or together while it is held. All of
/// it runs on one thread.
class BatchedStream {
 public:
  using next_layer_type = boost::beast::tcp_stream;
  using executor_type = next_layer_type::executor_type;
  using Error = boost::beast::error_code;

  explicit BatchedStream(next_layer_type&& next) : state_(std::make_shared<State>(std::move(next))) {}

  executor_type get_executor() noexcept { return state_->next.get_executor(); }
  next_layer_type& next_layer() noexcept { return state_->next; }
  const next_layer_type& next_layer() const noexcept { return state_->next; }

  /// Called whenever gathered bytes have left.
  void whenSent(std::function<void()> call) { state_->when_sent = std::move(call); }
  /// Bytes are gathered from now on.
  void hold() noexcept { state_->held = true; }
  /// What was gathered leaves, and so does what is written next.
  void release();
  /// More should not be written before bytes have left.
  bool full() const noexcept { return state_->gathered.size() >= kBatchBytes; }

  template <typename Buffers, typename Token>
  auto async_read_some(const Buffers& buffers, Token&& token) {
    return state_->next.async_read_some(buffers, std::forward<Token>(token));
  }

  /// Fails with no_buffer_space where a client that reads nothing asks for answers without end.
  template <typename Buffers, typename Token>
  auto async_write_some(const Buffers& buffers, Token&& token) {
    const std::size_t size = boost::beast::buffer_bytes(buffers);
    const bool fits = state_->gathered.size() + size <= kMostBytes;
    if (fits) {
      for (const auto buffer : boost::beast::buffers_range_ref(buffers)) {
        state_->gathered.append(static_cast<const char*>(buffer.data()), buffer.size());
      }
      if (!state_->held) {
        send(state_);
      }
    }
    return boost::asio::async_initiate<Token, void(Error, std::size_t)>(
        [state = state_](auto handler, Error error, std::size_t written) {
          boost::asio::post(state->next.get_executor(),
                            boost::beast::bind_front_handler(std::move(handler), error, written));
        },
        token, fits ? Error() : Error(boost::asio::error::no_buffer_space), fits ? size : 0U);
  }

 private:
  static constexpr std::size_t kBatchBytes = 1U << 16;
  static constexpr std::size_t kMostBytes = 1U << 20;

  /// Outlives the stream while bytes are on their way.
  struct State {
    explicit State(next_layer_type&& stream) : next(std::move(stream)) {}
    next_layer_type next;
    std::string gathered;
    std::string leaving;
    std::function<void()> when_sent;
    bool held = false;
    bool sending = false;
  };
  static void send(const std::shared_ptr<State>& state);

  std::shared_ptr<State> state_;
};

/// Ends a connection, for boost::beast::websocket::stream: what was gathered is sent before.
template <typename Handler>
// NOLINTNEXTLINE(readability-identifier-naming): Boost.Beast looks for it by this name
void async_teardown(boost::beast::role_type role, BatchedStream& stream, Handler&& handler) {
  stream.release();
  boost::beast::async_teardown(role, stream.next_layer(), std::forward<Handler>(handler));
}

}  // namespace patella::view
