// patella-report: a run folder as one page of figures and numbers.
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/files/json_file.hpp"
#include "tools/options/output_file.hpp"
#include "tools/options/run_program.hpp"
#include "tools/report/gnuplot.hpp"
#include "tools/report/html.hpp"
#include "tools/report/panels.hpp"
#include "tools/report/summary_values.hpp"

namespace {

nlohmann::json loadSummary(const std::filesystem::path& path) {
  if (!std::filesystem::exists(path)) {
    return nlohmann::json::object();
  }
  return patella::app::loadJson(path);
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  CLI::App arguments("Draws a recorded run: ticks.csv and summary.json of a run folder become one HTML page.",
                     "patella-report");
  arguments.set_version_flag("--version", std::string("patella-report ") + PATELLA_VERSION);
  std::filesystem::path run;
  std::filesystem::path page;
  std::filesystem::path picture;
  arguments.add_option("RUN_DIR", run, "folder that the loop has written")
      ->required()
      ->check(CLI::ExistingDirectory);
  arguments.add_option("--out", page, "page to write; RUN_DIR/report.html unless given");
  arguments.add_option("--png", picture, "also write all figures as one PNG picture");
  return patella::options::runProgram(arguments, argc, argv, [&] {
    page = page.empty() ? run / "report.html" : page;
    const auto recorded = patella::options::filesOfRun(run);
    patella::options::requireOther("--out", page, recorded);
    patella::options::requireOther("--png", picture, recorded);
    if (std::filesystem::weakly_canonical(page) == std::filesystem::weakly_canonical(picture)) {
      throw std::invalid_argument("--png: value '" + picture.string() +
                                  "', which is the page's, expected another file");
    }
    const auto ticks =
        patella::app::CsvTable::load(run / "ticks.csv", {.allow_missing = true, .allow_cut_off = true});
    if (ticks.cutOffLine()) {
      std::cerr << "patella-report: " << (run / "ticks.csv").string() << ":" << *ticks.cutOffLine()
                << ": the table ends within this line; what stands before it is drawn\n";
    }
    const nlohmann::json summary = loadSummary(run / "summary.json");
    if (const std::string missing = patella::report::missingTicks(ticks.rows(), summary); !missing.empty()) {
      std::cerr << "patella-report: " << (run / "ticks.csv").string() << ": " << missing << "\n";
    }
    const auto figures = patella::report::makePanels(ticks, summary);
    const std::string title = "Run " + std::filesystem::canonical(run).filename().string();
    patella::app::writeFile(
        page, patella::report::reportPage(title, figures, patella::report::drawSvg(figures), summary));
    std::cout << page.string() << ": " << figures.size() << " figures, " << ticks.rows() << " ticks\n";
    if (!picture.empty()) {
      patella::report::drawPng(figures, title, picture);
      std::cout << picture.string() << "\n";
    }
  });
}
