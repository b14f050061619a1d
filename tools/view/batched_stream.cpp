#include "tools/view/batched_stream.hpp"

#include <boost/asio/write.hpp>

namespace patella::view {

void BatchedStream::release() {
  state_->held = false;
  send(state_);
}

void BatchedStream::send(const std::shared_ptr<State>& state) {
  if (state->sending || state->gathered.empty()) {
    return;
  }
  state->sending = true;
  state->leaving.clear();
  state->leaving.swap(state->gathered);
  boost::asio::async_write(state->next, boost::asio::buffer(state->leaving),
                           [state](Error error, std::size_t /*size*/) {
                             state->sending = false;
                             // Who reads from a connection that has ended is told so there.
                             if (error) {
                               return;
                             }
                             if (!state->held) {
                               send(state);
                             }
                             if (state->when_sent) {
                               state->when_sent();
                             }
                           });
}

}  // namespace patella::view
