// patella-convert: recordings of other rigs as logs of frames that drive the loop, logs as tables, and runs
// in the formats of other programs.
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "drivers/can/dbc.hpp"
#include "tools/convert/conversion_map.hpp"
#include "tools/convert/csv_to_log.hpp"
#include "tools/convert/log_to_csv.hpp"
#include "tools/convert/run_to_bdf.hpp"
#include "tools/convert/run_to_mcap.hpp"
#include "tools/convert/run_to_opensim.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/output_file.hpp"
#include "tools/options/run_program.hpp"

namespace {

struct Arguments {
  std::filesystem::path recording;
  std::filesystem::path log;
  std::filesystem::path map;
  std::filesystem::path run;
  std::filesystem::path broken;
  std::vector<std::string> coordinates;
  std::vector<std::filesystem::path> attached;
  std::filesystem::path dbc;
  std::filesystem::path out;
  std::optional<double> rate_Hz;
  std::string row_message;
};

// Before anything is read: what is written takes the place of what stood there.
void requireOtherFile(const Arguments& arguments) {
  std::vector<std::filesystem::path> inputs = patella::options::filesOfRun(arguments.run);
  inputs.insert(inputs.end(),
                {arguments.recording, arguments.log, arguments.map, arguments.broken, arguments.dbc});
  inputs.insert(inputs.end(), arguments.attached.begin(), arguments.attached.end());
  patella::options::requireOther("--out", arguments.out, inputs);
}

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
            << " of unknown identifiers, " << report.unusable << " too short or corrupt";
  if (report.cut_line != 0) {
    std::cout << "; the log ends within line " << report.cut_line;
  }
  std::cout << "\n";
}

void writeMcap(const Arguments& arguments) {
  const auto report = patella::convert::convertRunToMcap(arguments.run, arguments.attached, arguments.out);
  std::cout << arguments.out.string() << ": " << report.ticks << " ticks, " << report.frames << " frames, "
            << report.events << " events, " << report.attachments << " attachments\n";
}

void recover(const Arguments& arguments) {
  const auto report = patella::convert::recoverMcap(arguments.broken, arguments.out);
  std::cout << arguments.out.string() << ": " << report.messages << " messages and " << report.attachments
            << " attachments, "
            << (report.cut
                    ? "of a file whose last whole record ends at byte " + std::to_string(report.read_to)
                    : std::string("of a file that was whole"))
            << "\n";
}

void writeBdf(const Arguments& arguments) {
  const auto report = patella::convert::convertRunToBdf(arguments.run, arguments.out);
  std::cout << arguments.out.string() << ": " << report.signals << " signals of " << report.samples
            << " samples at " << report.rate_Hz << " Hz, " << report.held
            << " of them held where a tick is missing, " << report.annotations << " annotations\n";
}

void tell(const Arguments& arguments, const patella::convert::OpenSimReport& report) {
  std::cout << arguments.out.string() << ": " << report.rows << " rows of";
  for (const std::string& column : report.columns) {
    std::cout << " " << column;
  }
  std::cout << "\n";
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App app(
      "Turns a recorded CSV into a log of CAN frames (candump -l), by a bus description and a map of columns "
      "to "
      "signals; with --decode, a log into a CSV of all signals; with --mcap, --bdf, --sto or --mot, a run "
      "into a file for other programs.",
      "patella-convert");
  app.set_version_flag("--version", std::string("patella-convert ") + PATELLA_VERSION);
  Arguments arguments;
  auto* recording = app.add_option("recording", arguments.recording, "CSV with a header of names")
                        ->check(CLI::ExistingFile);
  auto* map =
      app.add_option("--map", arguments.map, "map of columns to signals, TOML")->check(CLI::ExistingFile);
  auto* log =
      app.add_option("--decode", arguments.log, "log of frames to decode instead")->check(CLI::ExistingFile);
  auto* mcap = app.add_option("--mcap", arguments.run, "folder of a run to write as MCAP instead")
                   ->check(CLI::ExistingDirectory);
  auto* broken = app.add_option("--recover", arguments.broken,
                                "MCAP file that was cut off: write its whole records as a new one instead")
                     ->check(CLI::ExistingFile);
  app.add_option("--attach", arguments.attached,
                 "with --mcap: files that the run was configured from, known by their SHA-256")
      ->needs(mcap)
      ->check(CLI::ExistingFile);
  auto* bdf =
      app.add_option("--bdf", arguments.run, "folder of a run to write as BDF+ instead: EMG for its programs")
          ->check(CLI::ExistingDirectory);
  auto* sto = app.add_option("--sto", arguments.run,
                             "folder of a run to write for OpenSim instead: EMG, activation and torques")
                  ->check(CLI::ExistingDirectory);
  auto* mot = app.add_option("--mot", arguments.run, "folder of a run to write for OpenSim instead: angles")
                  ->check(CLI::ExistingDirectory);
  app.add_option("--coordinates", arguments.coordinates,
                 "with --mot: the OpenSim model's names of the joints, as hip_flexion_r,knee_angle_r")
      ->needs(mot)
      ->delimiter(',');
  auto* dbc = app.add_option("--dbc", arguments.dbc, "bus description")->check(CLI::ExistingFile);
  app.add_option("--out", arguments.out, "file to write")->required();
  auto* rate = app.add_option("--rate", arguments.rate_Hz, "uniform rate in Hz, instead of the map's")
                   ->check(patella::options::numberFrom(1.0, 20000.0));
  app.add_option("--rows", arguments.row_message,
                 "with --decode: message whose frames make the rows; the most frequent unless given")
      ->needs(log);
  log->excludes(recording)->excludes(map)->excludes(rate)->needs(dbc);
  const std::vector<CLI::Option*> forms{mcap, broken, bdf, sto, mot};
  for (auto* form : forms) {
    form->excludes(recording)->excludes(map)->excludes(rate)->excludes(log)->excludes(dbc);
    for (auto* other : forms) {
      if (other != form) {
        form->excludes(other);
      }
    }
  }
  recording->needs(map)->needs(dbc);
  map->needs(recording);
  return patella::options::runProgram(app, argc, argv, [&] {
    const bool no_form =
        std::all_of(forms.begin(), forms.end(), [](const auto* form) { return form->empty(); });
    if (log->empty() && recording->empty() && no_form) {
      throw std::invalid_argument(
          "expected a recording with --map, or one of --decode, --mcap, --recover, --bdf, --sto and --mot");
    }
    requireOtherFile(arguments);
    if (!mcap->empty()) {
      writeMcap(arguments);
    } else if (!broken->empty()) {
      recover(arguments);
    } else if (!bdf->empty()) {
      writeBdf(arguments);
    } else if (!sto->empty()) {
      tell(arguments, patella::convert::convertRunToSto(arguments.run, arguments.out));
    } else if (!mot->empty()) {
      tell(arguments, patella::convert::convertRunToMot(arguments.run, arguments.coordinates, arguments.out));
    } else {
      log->empty() ? encode(arguments) : decode(arguments);
    }
  });
}
