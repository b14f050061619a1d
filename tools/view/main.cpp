// patella-view: serves a live run to viewers. `patella view` starts it.
#include <csignal>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <boost/asio/signal_set.hpp>
#include <sched.h>

#include "tools/convert/progress.hpp"
#include "tools/options/run_program.hpp"
#include "tools/view/log_replay.hpp"
#include "tools/view/server.hpp"

namespace {

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

// The live run in a folder; nothing where there is none, or it has ended.
std::unique_ptr<patella::live::RingReader> liveRun(const std::filesystem::path& run) {
  try {
    auto ring = std::make_unique<patella::live::RingReader>(patella::live::ringName(run));
    return ring->ended() ? nullptr : std::move(ring);
  } catch (const std::runtime_error&) {
    return nullptr;
  }
}

std::unique_ptr<patella::view::Recording> recordedRun(const std::filesystem::path& run) {
  if (!std::filesystem::exists(run / "ticks.csv")) {
    throw std::runtime_error(run.string() +
                             ": no run is being recorded there, and it holds none (no ticks.csv)");
  }
  patella::convert::Progress progress;
  return std::make_unique<patella::view::Recording>(run, [&](double fraction) { progress.at(fraction); });
}

// Runs where the run's own helpers do, which keep off a processor that the loop is bound to. Another user's
// run, or one of another container, does not tell.
void keepOffTheLoop(int process) {
  cpu_set_t processors;
  if (sched_getaffinity(process, sizeof processors, &processors) == 0) {
    sched_setaffinity(0, sizeof processors, &processors);
  }
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
  const auto ring = liveRun(run);
  if (ring != nullptr) {
    keepOffTheLoop(ring->writer());
  }
  const auto recording = ring == nullptr ? recordedRun(run) : nullptr;
  boost::asio::io_context context;
  patella::view::Server server(context, options, {.ring = ring.get(), .recording = recording.get()});
  boost::asio::signal_set signals(context, SIGINT, SIGTERM);
  signals.async_wait([&](const boost::system::error_code& /*error*/, int /*signal*/) { context.stop(); });
  server.start();
  const bool version_6 = options.address.find(':') != std::string::npos;
  std::cout << "serving " << options.name << (ring == nullptr ? ", which has ended," : "") << " at http://"
            << (version_6 ? "[" + options.address + "]" : options.address) << ":" << server.port()
            << std::endl;
  context.run();
  if (ring != nullptr && ring->overruns() > 0) {
    std::cerr << "patella-view: " << ring->overruns() << " times this process was too slow for the run\n";
  }
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app(
      "Serves a run to browsers, and while it lasts to Foxglove, Lichtblick and PlotJuggler. It only reads.",
      "patella view");
  app.set_version_flag("--version", std::string("patella-view ") + PATELLA_VERSION);
  std::filesystem::path run;
  std::string listen = "127.0.0.1:8765";
  std::filesystem::path token_file;
  patella::view::ServerOptions options;
  std::filesystem::path config;
  app.add_option("RUN", run, "folder that a run is being recorded into, or was; or a log of candump -l")
      ->required();
  app.add_option("--config", config, "with a log: configuration of the loop that it is played to")
      ->check(CLI::ExistingFile);
  app.add_option("--listen", listen, "address and port; another than this machine's own needs a token")
      ->capture_default_str();
  app.add_option("--token-file", token_file, "file with the token that clients have to give as ?token=...")
      ->check(CLI::ExistingFile);
  app.add_option("--allow-origin", options.access.origins,
                 "pages of other sites that may connect, as https://host");
  return patella::options::runProgram(app, argc, argv, [&] {
    parseListen(listen, options);
    if (!token_file.empty()) {
      options.access.token = patella::view::readToken(token_file);
    }
    options.name = "Patella, " + std::filesystem::weakly_canonical(run).filename().string();
    std::optional<patella::view::LogReplay> replay;
    if (!config.empty() && std::filesystem::is_directory(run)) {
      throw std::runtime_error("--config: value '" + config.string() + "' with the folder " + run.string() +
                               ", expected a log of frames with it: a folder holds what its run was made of");
    }
    if (std::filesystem::is_regular_file(run)) {
      replay.emplace(run, config);
    }
    serve(replay ? replay->folder() : run, options);
  });
}
