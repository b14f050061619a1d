// patella-view: serves a live run to viewers. `patella view` starts it.
#include <csignal>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <boost/asio/signal_set.hpp>

#include "tools/view/server.hpp"

namespace {

constexpr std::size_t kShortestToken = 16;

// "127.0.0.1:8765" or "[::1]:8765".
void parseListen(const std::string& text, patella::view::ServerOptions& options) {
  const std::size_t colon = text.rfind(':');
  const std::string address = text.substr(0, colon);
  const std::string port = colon == std::string::npos ? "" : text.substr(colon + 1);
  const bool bracketed = address.size() > 2 && address.front() == '[' && address.back() == ']';
  const bool number =
      !port.empty() && port.size() <= 5 && port.find_first_not_of("0123456789") == std::string::npos;
  if (address.empty() || !number || std::stoul(port) > 65535) {
    throw std::runtime_error("--listen: value '" + text + "', expected ADDRESS:PORT as 127.0.0.1:8765");
  }
  options.address = bracketed ? address.substr(1, address.size() - 2) : address;
  options.port = static_cast<std::uint16_t>(std::stoul(port));
}

std::string readToken(const std::filesystem::path& file) {
  std::ifstream stream(file);
  std::string token;
  stream >> token;
  if (token.size() < kShortestToken) {
    throw std::runtime_error(file.string() + ": a token of " + std::to_string(token.size()) +
                             " characters, expected at least " + std::to_string(kShortestToken));
  }
  return token;
}

void serve(const std::filesystem::path& run, patella::view::ServerOptions options) {
  boost::system::error_code error;
  const auto address = boost::asio::ip::make_address(options.address, error);
  if (!error && !address.is_loopback() && options.access.token.empty()) {
    throw std::runtime_error(
        "--listen: " + options.address +
        " can be reached from other machines, and what is shown is about a patient; expected "
        "--token-file with it, or 127.0.0.1");
  }
  options.name = "Patella, " + run.filename().string();
  patella::live::RingReader ring(patella::live::ringName(run));
  boost::asio::io_context context;
  patella::view::Server server(context, options, ring);
  boost::asio::signal_set signals(context, SIGINT, SIGTERM);
  signals.async_wait([&](const boost::system::error_code& /*error*/, int /*signal*/) { context.stop(); });
  server.start();
  const bool version_6 = options.address.find(':') != std::string::npos;
  std::cout << "serving " << run.string() << " at "
            << (version_6 ? "[" + options.address + "]" : options.address) << ":" << server.port()
            << std::endl;
  context.run();
  if (ring.overruns() > 0) {
    std::cerr << "patella-view: " << ring.overruns() << " times this process was too slow for the run\n";
  }
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app("Serves a live run to Foxglove, Lichtblick and PlotJuggler. It only reads.", "patella view");
  app.set_version_flag("--version", std::string("patella-view ") + PATELLA_VERSION);
  std::filesystem::path run;
  std::string listen = "127.0.0.1:8765";
  std::filesystem::path token_file;
  patella::view::ServerOptions options;
  app.add_option("RUN", run, "folder that the run is being recorded into")->required();
  app.add_option("--listen", listen, "address and port; another than this machine's own needs a token")
      ->capture_default_str();
  app.add_option("--token-file", token_file, "file with the token that clients have to give as ?token=...")
      ->check(CLI::ExistingFile);
  app.add_option("--allow-origin", options.access.origins,
                 "pages of other sites that may connect, as https://host");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 1;
  }
  try {
    parseListen(listen, options);
    if (!token_file.empty()) {
      options.access.token = readToken(token_file);
    }
    serve(run, options);
  } catch (const std::exception& error) {
    std::cerr << "patella view: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
