#include "tools/view/client.hpp"

#include <algorithm>
#include <array>
#include <chrono>

#include <nlohmann/json.hpp>

namespace patella::view {
namespace {

namespace beast = boost::beast;
namespace websocket = boost::beast::websocket;

constexpr std::array<std::string_view, 2> kSubprotocols = {"foxglove.sdk.v1", "foxglove.websocket.v1"};
constexpr std::size_t kLongestRequest = 1U << 14;
constexpr std::size_t kQueueBytes = 4U << 20;
constexpr std::size_t kMostComplaints = 16;  // that wait: who sends garbage is not answered without end
constexpr auto kSilence = std::chrono::seconds(20);

}  // namespace

Catalogue catalogueOf(const std::string& name, const std::vector<formats::ChannelDescription>& channels) {
  using Json = nlohmann::json;
  Json list = Json::array();
  Json metadata = Json::object();
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const formats::ChannelDescription& channel = channels[i];
    list.push_back({{"id", i},
                    {"topic", channel.topic},
                    {"encoding", "cdr"},
                    {"schemaName", channel.type},
                    {"schema", channel.definition},
                    {"schemaEncoding", "ros2msg"}});
    if (!channel.columns.empty()) {
      metadata["columns"] = channel.columns;
    }
  }
  const Json info{{"op", "serverInfo"},
                  {"name", name},
                  {"capabilities", Json::array()},
                  {"supportedEncodings", Json::array()},
                  {"metadata", metadata}};
  return {info.dump(), Json{{"op", "advertise"}, {"channels", list}}.dump(), channels.size()};
}

std::string subprotocolOf(const Request& request) {
  const auto field = request[beast::http::field::sec_websocket_protocol];
  const std::string offered(field.data(), field.size());
  for (const auto& token : beast::http::token_list(offered)) {
    const std::string_view name(token.data(), token.size());
    if (std::find(kSubprotocols.begin(), kSubprotocols.end(), name) != kSubprotocols.end()) {
      return std::string(name);
    }
  }
  return {};
}

Client::Client(beast::tcp_stream&& stream, const Catalogue& catalogue)
    : socket_(std::move(stream)), catalogue_(catalogue), subscriptions_(catalogue.channels) {}

void Client::start(const Request& request, const std::string& subprotocol) {
  beast::get_lowest_layer(socket_).expires_never();
  auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
  timeout.idle_timeout = kSilence;
  timeout.keep_alive_pings = true;
  socket_.set_option(timeout);
  socket_.set_option(websocket::stream_base::decorator([subprotocol](websocket::response_type& response) {
    response.set(beast::http::field::sec_websocket_protocol, subprotocol);
  }));
  socket_.read_message_max(kLongestRequest);
  socket_.next_layer().whenSent([client = weak_from_this()] {
    if (const auto self = client.lock(); self != nullptr && self->open_) {
      self->startWriting();
    }
  });
  socket_.async_accept(request, [self = shared_from_this()](beast::error_code error) {
    if (error) {
      self->fail();
      return;
    }
    self->open_ = true;
    self->tell(self->catalogue_.server_info);
    self->tell(self->catalogue_.advertise);
    self->read();
  });
}

void Client::read() {
  socket_.async_read(incoming_, [self = shared_from_this()](beast::error_code error, std::size_t /*size*/) {
    if (error) {
      self->fail();
      return;
    }
    const std::string text = beast::buffers_to_string(self->incoming_.data());
    self->incoming_.consume(self->incoming_.size());
    if (self->socket_.got_text()) {
      if (const std::string complaint = self->subscriptions_.obey(text); !complaint.empty()) {
        self->complain(complaint);
      }
    } else {
      self->complain("binary messages are for commands, and nobody commands through this server");
    }
    self->read();
  });
}

void Client::complain(const std::string& words) {
  const auto texts =
      std::count_if(outgoing_.begin(), outgoing_.end(), [](const Outgoing& o) { return o.text; });
  if (static_cast<std::size_t>(texts) < kMostComplaints) {
    tellStatus(Level::kWarning, words);
  }
}

void Client::tellStatus(Level level, const std::string& words) {
  // A request may hold bytes that are no text.
  tell(nlohmann::json{{"op", "status"}, {"level", level}, {"message", words}}.dump(
      -1, ' ', true, nlohmann::json::error_handler_t::replace));
}

void Client::end() {
  if (open_) {
    tellStatus(Level::kInfo, "the run has ended");
  }
}

void Client::tell(std::string text) {
  queue({std::move(text), true});
}

void Client::send(std::uint16_t channel, std::uint64_t time_ns, std::string_view message) {
  if (!open_) {
    return;
  }
  for (const auto& [id, subscribed] : subscriptions_.all()) {
    if (subscribed == channel) {
      queue({messageData(id, time_ns, message), false});
    }
  }
}

void Client::queue(Outgoing&& outgoing) {
  queued_bytes_ += outgoing.bytes.size();
  outgoing_.push_back(std::move(outgoing));
  // What is being written stays, and so does text: only data grow without end.
  for (auto oldest = outgoing_.begin() + 1; queued_bytes_ > kQueueBytes && oldest < outgoing_.end();) {
    if (oldest->text) {
      ++oldest;
      continue;
    }
    queued_bytes_ -= oldest->bytes.size();
    oldest = outgoing_.erase(oldest);
    ++dropped_;
  }
  startWriting();
}

// Messages of one look at the run leave together.
void Client::startWriting() {
  if (!writing_ && !outgoing_.empty() && !socket_.next_layer().full()) {
    socket_.next_layer().hold();
    write();
  }
}

void Client::write() {
  writing_ = false;
  if (outgoing_.empty() && dropped_ != dropped_told_) {
    dropped_told_ = dropped_;
    complain("this client is slow: " + std::to_string(dropped_) + " messages were left out");
    return;
  }
  if (outgoing_.empty() || socket_.next_layer().full()) {
    socket_.next_layer().release();
    return;
  }
  writing_ = true;
  socket_.text(outgoing_.front().text);
  socket_.async_write(boost::asio::buffer(outgoing_.front().bytes),
                      [self = shared_from_this()](beast::error_code error, std::size_t /*size*/) {
                        if (error) {
                          self->writing_ = false;
                          self->fail();
                          return;
                        }
                        self->queued_bytes_ -= self->outgoing_.front().bytes.size();
                        self->outgoing_.pop_front();
                        self->write();
                      });
}

void Client::fail() noexcept {
  open_ = false;
  beast::get_lowest_layer(socket_).close();
}

}  // namespace patella::view
