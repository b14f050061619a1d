#include "tools/view/server.hpp"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <optional>
#include <stdexcept>
#include <string_view>

#include "firmware_app/live/live_run.hpp"
#include "tools/view/page.hpp"

namespace patella::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

constexpr auto kPumpPeriod = std::chrono::milliseconds(10);
constexpr auto kPatience = std::chrono::seconds(10);        // for a request to arrive, and an answer to leave
constexpr auto kFarewell = std::chrono::milliseconds(200);  // for the last messages to leave
constexpr std::size_t kMostVisits = 32;
constexpr std::uint32_t kLongestHeader = 8192;

struct Answer {
  http::status status = http::status::ok;
  std::string body;
  const char* type = "text/plain; charset=utf-8";
  std::string policy = "default-src 'none'";
};

Answer refused(http::status status, const std::string& words) {
  return {.status = status, .body = words + "\n"};
}

// "/recording/12" with the prefix "/recording/" is 12; nothing for what is no number.
std::optional<std::size_t> numberBehind(std::string_view path, std::string_view prefix) {
  std::size_t number = 0;
  if (!path.starts_with(prefix)) {
    return std::nullopt;
  }
  path.remove_prefix(prefix.size());
  const auto [end, error] = std::from_chars(path.data(), path.data() + path.size(), number);
  return error == std::errc() && end == path.data() + path.size() ? std::optional(number) : std::nullopt;
}

Answer answerTo(std::string_view path, const Catalogue& catalogue, const Recording* recording) {
  if (path == "/") {
    const std::string nonce = freshNonce();
    return {.body = pageFor(recording == nullptr ? PageKind::kLive : PageKind::kRecording, nonce),
            .type = "text/html; charset=utf-8",
            .policy = contentPolicy(nonce)};
  }
  if (recording != nullptr && path == "/recording") {
    return {.body = "{\"server_info\":" + catalogue.server_info + ",\"advertise\":" + catalogue.advertise +
                    ",\"recording\":" + recording->index() + "}",
            .type = "application/json"};
  }
  const auto second = numberBehind(path, "/recording/");
  if (recording != nullptr && second && *second < recording->seconds()) {
    return {.body = recording->messagesOf(*second), .type = "application/octet-stream"};
  }
  return refused(http::status::not_found, "there is nothing of that name");
}

}  // namespace

// A connection until it is answered or has become a client's.
struct Server::Visit {
  Visit(asio::ip::tcp::socket&& socket, std::size_t& visits) : stream(std::move(socket)), count(visits) {
    ++count;
  }
  ~Visit() { --count; }
  Visit(const Visit&) = delete;
  Visit& operator=(const Visit&) = delete;

  beast::tcp_stream stream;
  beast::flat_buffer buffer{kLongestHeader};
  http::request_parser<http::empty_body> parser;
  http::response<http::string_body> response;
  std::size_t& count;
};

Server::Server(asio::io_context& context, const ServerOptions& options, const Shown& shown)
    : context_(context),
      access_(options.access),
      shown_(shown),
      catalogue_(catalogueOf(options.name, shown.recording != nullptr
                                               ? shown.recording->channels()
                                               : live::channelsOf(shown.ring->description()))),
      acceptor_(context),
      timer_(context) {
  beast::error_code error;
  const asio::ip::tcp::endpoint endpoint(asio::ip::make_address(options.address, error), options.port);
  if (error) {
    throw std::runtime_error("--listen: value '" + options.address + "', expected an address of numbers");
  }
  acceptor_.open(endpoint.protocol());
  acceptor_.set_option(asio::socket_base::reuse_address(true));
  acceptor_.bind(endpoint, error);
  if (!error) {
    acceptor_.listen(asio::socket_base::max_listen_connections, error);
  }
  if (error) {
    throw std::runtime_error(options.address + ":" + std::to_string(options.port) + ": " + error.message());
  }
  access_.hosts = hostsOf(options.address, port());
}

std::uint16_t Server::port() const {
  return acceptor_.local_endpoint().port();
}

void Server::start() {
  accept();
  if (shown_.ring != nullptr) {
    pump();
  }
}

void Server::accept() {
  acceptor_.async_accept([this](beast::error_code error, asio::ip::tcp::socket socket) {
    if (error == asio::error::operation_aborted) {
      return;
    }
    if (!error && visits_ < kMostVisits) {
      const auto visit = std::make_shared<Visit>(std::move(socket), visits_);
      visit->parser.header_limit(kLongestHeader);
      visit->parser.body_limit(0);
      visit->stream.expires_after(kPatience);
      http::async_read(visit->stream, visit->buffer, visit->parser,
                       [this, visit](beast::error_code failed, std::size_t /*size*/) {
                         if (!failed) {
                           answer(visit);
                         }
                       });
    }
    accept();
  });
}

void Server::answer(const std::shared_ptr<Visit>& visit) {
  const Request& request = visit->parser.get();
  const auto text = [&](http::field field) { return std::string(request[field]); };
  const std::string why =
      refusal(access_, {text(http::field::host), text(http::field::origin), std::string(request.target())});
  const bool upgrade = beast::websocket::is_upgrade(request);
  const std::string subprotocol = upgrade ? subprotocolOf(request) : "";
  Answer answer;
  if (!why.empty()) {
    answer = refused(http::status::forbidden, why);
  } else if (upgrade && shown_.ring == nullptr) {
    answer = refused(http::status::bad_request,
                     "this run has ended: patella-convert --mcap makes a file of it for Foxglove");
  } else if (upgrade && subprotocol.empty()) {
    answer = refused(http::status::bad_request,
                     "expected the subprotocol foxglove.sdk.v1 or foxglove.websocket.v1");
  } else if (upgrade && openClients() >= kMostClients) {
    answer =
        refused(http::status::service_unavailable, "eight clients are connected, and no more are served");
  } else if (upgrade) {
    clients_.push_back(std::make_shared<Client>(std::move(visit->stream), catalogue_));
    clients_.back()->start(request, subprotocol);
    return;
  } else if (request.method() != http::verb::get) {
    answer = refused(http::status::method_not_allowed, "nothing can be done here but to look");
  } else {
    const std::string_view target(request.target().data(), request.target().size());
    answer = answerTo(target.substr(0, target.find('?')), catalogue_, shown_.recording);
  }
  http::response<http::string_body>& response = visit->response;
  response.version(request.version());
  response.result(answer.status);
  response.set(http::field::content_type, answer.type);
  response.set(http::field::cache_control, "no-store");
  response.set("Content-Security-Policy", answer.policy);
  response.set("X-Content-Type-Options", "nosniff");
  response.set("Referrer-Policy", "no-referrer");
  response.keep_alive(false);
  response.body() = std::move(answer.body);
  response.prepare_payload();
  visit->stream.expires_after(kPatience);
  http::async_write(visit->stream, response, [visit](beast::error_code /*error*/, std::size_t /*size*/) {
    beast::error_code ignored;
    visit->stream.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
  });
}

std::size_t Server::openClients() {
  std::erase_if(clients_, [](const auto& client) { return client.use_count() == 1; });
  return clients_.size();
}

void Server::pump() {
  live::LiveMessage message;
  while (shown_.ring->next(message)) {
    for (const auto& client : clients_) {
      client->send(message.channel, message.wall_ns, message.data);
    }
  }
  openClients();
  if (shown_.ring->ended()) {
    for (const auto& client : clients_) {
      client->end();
    }
    timer_.expires_after(kFarewell);
    timer_.async_wait([this](beast::error_code /*error*/) { context_.stop(); });
    return;
  }
  timer_.expires_after(kPumpPeriod);
  timer_.async_wait([this](beast::error_code error) {
    if (!error) {
      pump();
    }
  });
}

}  // namespace patella::view
