#include "tools/view/server.hpp"

#include <algorithm>
#include <chrono>
#include <stdexcept>

#include "firmware_app/live/live_run.hpp"

namespace patella::view {
namespace {

namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = boost::beast::http;

constexpr auto kPumpPeriod = std::chrono::milliseconds(10);
constexpr auto kPatience = std::chrono::seconds(10);  // for a request to arrive, and an answer to leave
constexpr std::size_t kMostVisits = 32;
constexpr std::uint32_t kLongestHeader = 8192;

constexpr const char* kPage =
    "<!doctype html><html lang=\"en\"><meta charset=\"utf-8\"><title>Patella</title>"
    "<h1>Patella</h1><p>A run is served here to Foxglove, Lichtblick and PlotJuggler: open a Foxglove "
    "WebSocket "
    "connection to this address, with ws:// in place of http://.</p></html>\n";

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

Server::Server(asio::io_context& context, const ServerOptions& options, live::RingReader& ring)
    : context_(context),
      access_(options.access),
      catalogue_(catalogueOf(options.name, live::channelsOf(ring.description()))),
      ring_(ring),
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
  pump();
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
  const auto respond = [&](http::status status, const std::string& body, const char* type) {
    auto& response = visit->response;
    response.version(request.version());
    response.result(status);
    response.set(http::field::content_type, type);
    response.set(http::field::cache_control, "no-store");
    response.set("Content-Security-Policy", "default-src 'none'");
    response.set("X-Content-Type-Options", "nosniff");
    response.keep_alive(false);
    response.body() = body;
    response.prepare_payload();
    visit->stream.expires_after(kPatience);
    http::async_write(visit->stream, response, [visit](beast::error_code /*error*/, std::size_t /*size*/) {
      beast::error_code ignored;
      visit->stream.socket().shutdown(asio::ip::tcp::socket::shutdown_send, ignored);
    });
  };
  const std::string path = std::string(request.target().substr(0, request.target().find('?')));
  if (!why.empty()) {
    respond(http::status::forbidden, why + "\n", "text/plain; charset=utf-8");
  } else if (upgrade && subprotocol.empty()) {
    respond(http::status::bad_request, "expected the subprotocol foxglove.sdk.v1 or foxglove.websocket.v1\n",
            "text/plain; charset=utf-8");
  } else if (upgrade && openClients() >= kMostClients) {
    respond(http::status::service_unavailable, "eight clients are connected, and no more are served\n",
            "text/plain; charset=utf-8");
  } else if (upgrade) {
    clients_.push_back(std::make_shared<Client>(std::move(visit->stream), catalogue_));
    clients_.back()->start(request, subprotocol);
  } else if (request.method() == http::verb::get && path == "/") {
    respond(http::status::ok, kPage, "text/html; charset=utf-8");
  } else {
    respond(http::status::not_found, "there is nothing but /\n", "text/plain; charset=utf-8");
  }
}

std::size_t Server::openClients() {
  std::erase_if(clients_, [](const auto& client) { return client.use_count() == 1; });
  return clients_.size();
}

void Server::pump() {
  live::LiveMessage message;
  while (ring_.next(message)) {
    for (const auto& client : clients_) {
      client->send(message.channel, message.wall_ns, message.data);
    }
  }
  openClients();
  if (ring_.ended()) {
    context_.stop();
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
