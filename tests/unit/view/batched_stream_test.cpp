// Two ends of a connection on the loopback: what leaves when, and what does not.
#include "tools/view/batched_stream.hpp"

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/asio/write.hpp>
#include <doctest/doctest.h>

namespace {

using namespace patella::view;
namespace asio = boost::asio;
using asio::ip::tcp;

struct Connection {
  asio::io_context context;
  tcp::socket reader{context};
  BatchedStream stream{connected()};

  boost::beast::tcp_stream connected() {
    tcp::acceptor acceptor(context, {asio::ip::make_address("127.0.0.1"), 0});
    reader.connect(acceptor.local_endpoint());
    return boost::beast::tcp_stream(acceptor.accept());
  }
  /// Writes, runs what follows from it, and returns how it ended.
  boost::system::error_code write(const std::string& bytes) {
    boost::system::error_code ended = asio::error::would_block;
    asio::async_write(stream, asio::buffer(bytes),
                      [&](boost::system::error_code error, std::size_t /*size*/) { ended = error; });
    run();
    return ended;
  }
  void run() {
    context.restart();
    context.poll();
  }
  /// What has arrived by now.
  std::string arrived() {
    std::string bytes, part(1U << 16, '\0');
    boost::system::error_code error;
    reader.non_blocking(true);
    while (const std::size_t size = reader.read_some(asio::buffer(part), error)) {
      bytes.append(part, 0, size);
      run();
    }
    return bytes;
  }
};

TEST_CASE("bytes leave at once, and together while the stream is held") {
  Connection connection;
  CHECK_FALSE(connection.write("at once"));
  CHECK(connection.arrived() == "at once");
  connection.stream.hold();
  CHECK_FALSE(connection.write("one, "));
  CHECK_FALSE(connection.write("two"));
  CHECK(connection.arrived().empty());
  connection.stream.release();
  connection.run();
  CHECK(connection.arrived() == "one, two");
  CHECK_FALSE(connection.write(" and after"));
  CHECK(connection.arrived() == " and after");
}

TEST_CASE("a stream that is full says so, and tells when its bytes have left") {
  Connection connection;
  int told = 0;
  connection.stream.whenSent([&] { ++told; });
  connection.stream.hold();
  CHECK_FALSE(connection.write(std::string(100'000, 'x')));
  CHECK(connection.stream.full());
  CHECK(told == 0);
  connection.stream.release();
  connection.run();
  CHECK_FALSE(connection.stream.full());
  CHECK(told == 1);
  CHECK(connection.arrived().size() == 100'000);
}

TEST_CASE("who reads nothing and asks without end gets an error, and the memory stays bounded") {
  Connection connection;
  const std::string answer(1U << 16, 'p');
  boost::system::error_code error;
  int written = 0;
  for (; !error && written < 1000; ++written) {
    error = connection.write(answer);
  }
  CHECK(error == asio::error::no_buffer_space);
  CHECK(written < 500);
}

TEST_CASE("what was gathered arrives before the connection ends") {
  Connection connection;
  connection.stream.hold();
  CHECK_FALSE(connection.write("farewell"));
  bool ended = false;
  async_teardown(boost::beast::role_type::server, connection.stream,
                 [&](boost::beast::error_code /*error*/) { ended = true; });
  connection.run();
  CHECK(connection.arrived() == "farewell");
  connection.reader.close();
  connection.run();
  CHECK(ended);
}

}  // namespace
