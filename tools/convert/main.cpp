// patella-convert: recordings of other rigs as logs of frames that drive the loop, and logs as tables.
#include <exception>
#include <filesystem>
#include <iostream>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "drivers/can/dbc.hpp"
#include "tools/convert/conversion_map.hpp"
#include "tools/convert/csv_to_log.hpp"
#include "tools/convert/log_to_csv.hpp"

namespace {

struct Arguments {
  std::filesystem::path recording;
  std::filesystem::path log;
  std::filesystem::path map;
  std::filesystem::path dbc;
  std::filesystem::path out;
  std::optional<double> rate_Hz;
  std::string row_message;
};

void encode(const Arguments& arguments) {
  const auto database = patella::can::loadDbc(arguments.dbc);
  auto map = patella::convert::loadMap(arguments.map, database);
  if (arguments.rate_Hz) {
    map.rate_Hz = arguments.rate_Hz;
  }
  const auto report = patella::convert::convertToLog(arguments.recording, map, database, arguments.out);
  std::cout << arguments.out.string() << ": " << report.frames << " frames at " << report.instants
            << " instants from " << report.rows << " rows; " << report.repeated_stamps
            << " rows with a repeated stamp left out, " << report.clipped << " values clipped, longest gap "
            << report.longest_gap_s << " s before line " << report.longest_gap_line << "\n";
}

void decode(const Arguments& arguments) {
  const auto database = patella::can::loadDbc(arguments.dbc);
  const auto report =
      patella::convert::convertToCsv(arguments.log, database, arguments.row_message, arguments.out);
  std::cout << arguments.out.string() << ": " << report.rows << " rows, one for each frame of "
            << report.row_message << ", from " << report.frames << " frames; " << report.unknown
            << " of unknown identifiers, " << report.unusable << " too short or corrupt\n";
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app(
      "Turns a recorded CSV into a log of CAN frames (candump -l), by a bus description and a map of columns "
      "to "
      "signals; with --decode, a log into a CSV of all signals.",
      "patella-convert");
  app.set_version_flag("--version", std::string("patella-convert ") + PATELLA_VERSION);
  Arguments arguments;
  auto* recording = app.add_option("recording", arguments.recording, "CSV with a header of names")
                        ->check(CLI::ExistingFile);
  auto* map =
      app.add_option("--map", arguments.map, "map of columns to signals, TOML")->check(CLI::ExistingFile);
  auto* log =
      app.add_option("--decode", arguments.log, "log of frames to decode instead")->check(CLI::ExistingFile);
  app.add_option("--dbc", arguments.dbc, "bus description")->required()->check(CLI::ExistingFile);
  app.add_option("--out", arguments.out, "file to write")->required();
  auto* rate = app.add_option("--rate", arguments.rate_Hz, "uniform rate in Hz, instead of the map's")
                   ->check(CLI::Range(1.0, 20000.0));
  app.add_option("--rows", arguments.row_message,
                 "with --decode: message whose frames make the rows; the most frequent unless given")
      ->needs(log);
  log->excludes(recording)->excludes(map)->excludes(rate);
  recording->needs(map);
  map->needs(recording);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 1;
  }
  if (log->empty() && recording->empty()) {
    std::cerr << "patella-convert: expected a recording with --map, or --decode LOG\n";
    return 1;
  }

  try {
    log->empty() ? encode(arguments) : decode(arguments);
  } catch (const std::exception& error) {
    std::cerr << "patella-convert: " << error.what() << "\n";
    return 1;
  }
  return 0;
}
