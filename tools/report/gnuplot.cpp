#include "tools/report/gnuplot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <stdexcept>

#include "drivers/files/temporary_folder.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/wording.hpp"
#include "tools/process/process.hpp"
#include "tools/report/palette.hpp"

namespace patella::report {
namespace {

using app::formatNumber;

constexpr int kFigureHeight = 300;
constexpr int kFigureWidth = 760;
constexpr int kWideWidth = 1540;

/// Draws into `folder`, which takes the script and what gnuplot says, too: it warns of a curve without
/// points, which a joint at rest has.
void run(const std::string& script, const files::TemporaryFolder& folder) {
  const std::string file = (folder / "script.gnuplot").string();
  const std::filesystem::path log = folder / "gnuplot.log";
  app::writeFile(file, script);
  const process::Ending ending = process::wait(process::start({"gnuplot", file}, {.output = log}));
  constexpr int kCommandNotFound = 127;
  if (ending.exit_status == kCommandNotFound) {
    throw std::runtime_error("gnuplot is not installed (Debian package gnuplot-nox)");
  }
  if (ending.exit_status != 0) {
    std::ostringstream said;
    said << std::ifstream(log).rdbuf();
    throw std::runtime_error("gnuplot failed: " + said.str());
  }
}

std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
    }
    result += c == '\n' ? ' ' : c;
  }
  return result + '"';
}

/// Range of all curves and levels with some air, so that flat curves do not touch the frame.
std::pair<double, double> verticalRange(const Figure& figure) {
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  const auto include = [&](double value) {
    if (std::isfinite(value) && (value > 0.0 || !figure.log_y)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  };
  for (const Series& series : figure.series) {
    for (std::size_t i = 0; i < series.y.size() && !series.right_axis; ++i) {
      const double error = series.error.empty() ? 0.0 : series.error[i];
      include(series.y[i] - error);
      include(series.y[i] + error);
    }
  }
  if (figure.log_y) {
    // Whole decades: there are no other ticks.
    return low <= high ? std::pair{std::pow(10.0, std::floor(std::log10(low))),
                                   std::pow(10.0, std::ceil(std::log10(high)))}
                       : std::pair{0.1, 10.0};
  }
  const double span = high - low;
  for (const Level& level : figure.levels) {
    // A limit far away is worth less than the shape of the curve.
    if (!level.vertical && level.value > low - 2.0 * span && level.value < high + 2.0 * span) {
      include(level.value);
    }
  }
  if (!(low <= high)) {
    return {-1.0, 1.0};
  }
  const double air = std::max(0.06 * (high - low), 1e-6 + 1e-3 * std::max(std::abs(low), std::abs(high)));
  return {low - air, high + air};
}

std::string rangeText(const std::pair<double, double>& range) {
  return "[" + formatNumber(range.first) + ":" + formatNumber(range.second) + "]";
}

void writeCommon(std::ostream& script, const Figure& figure) {
  // The title stands at the left of the line on which the key stands at the right.
  script << "unset logscale\nunset object\nunset arrow\nunset label\nunset y2tics\nunset y2label\n"
         << "set label " << quoted(figure.title)
         << " at graph 0,graph 1 left offset 0,0.9 font ',13' noenhanced\n"
         << "set xlabel " << quoted(figure.x_label) << " noenhanced offset 0,0.4\n"
         << "set ylabel " << quoted(figure.y_label) << " noenhanced offset 0.5,0\n"
         << "set ytics auto nomirror enhanced\nset xtics auto nomirror\nset format y '%g'\n"
         << "set border 3 lc rgb '" << colour::kAxis << "'\nset grid x y lc rgb '" << colour::kGrid
         << "' lt 1 lw 0.6\n"
         << "set lmargin 9\nset rmargin 4\nset tmargin 3.2\nset bmargin 3\n"
         << "set key at graph 1,graph 1.03 right bottom horizontal samplen 1.6 noenhanced\n";
  if (figure.x_range && figure.x_range->first < figure.x_range->second) {
    script << "set xrange " << rangeText(*figure.x_range) << "\n";
  } else {
    script << "set xrange [*:*]\n";
  }
  if (!figure.x_ticks.empty()) {
    script << "set xtics (";
    for (std::size_t i = 0; i < figure.x_ticks.size(); ++i) {
      script << (i == 0 ? "" : ",") << formatNumber(figure.x_ticks[i]);
    }
    script << ") nomirror\n";
  }
  if (figure.log_x) {
    script << "set logscale x\n";
  }
  if (figure.log_y) {
    script << "set logscale y\nset format y '10^{%T}'\n";
  }
}

void writeData(std::ostream& script, const Series& series) {
  for (std::size_t k = 0; k < series.x.size(); ++k) {
    if (std::isfinite(series.y[k])) {
      std::array<char, 96> line{};
      std::snprintf(line.data(), line.size(), "%.7g %.5g %.5g\n", series.x[k], series.y[k],
                    series.error.empty() ? 0.0 : series.error[k]);
      script << line.data();
    } else {
      script << "\n";
    }
  }
}

/// The plot elements of one series, in gnuplot's words.
std::string plotted(const Series& series, const std::string& data) {
  const std::string axes = series.right_axis ? " axes x1y2" : "";
  const std::string colour = " lc rgb '" + series.colour + "'";
  const std::string width = formatNumber(series.width);
  if (series.points) {
    // A dot this small is no good in a key: that shows a larger one of the same colour.
    return data + " using 1:2 with points pt 7 ps " + width + axes + colour + " notitle" +
           (series.label.empty()
                ? ""
                : ", 1/0 with points pt 7 ps 0.7" + colour + " title " + quoted(series.label));
  }
  const std::string line = data + " using 1:2 with " + (series.steps ? "steps" : "lines") + axes + colour +
                           " lw " + width + (series.dashed ? " dt (8,4)" : " dt 1") + " title " +
                           quoted(series.label);
  return series.error.empty() ? line
                              : line + ", " + data + " using 1:2:3 with yerrorbars" + axes + colour +
                                    " lw 1 pt 7 ps 0.5 notitle";
}

void writeLevels(std::ostream& script, const Figure& figure, const std::pair<double, double>& range) {
  for (const Level& level : figure.levels) {
    const std::string value = formatNumber(level.value);
    const std::string style = " nohead dt (6,4) lw 1 lc rgb '" + std::string(colour::kAlarm) + "' front\n";
    const std::string words = quoted(level.label);
    if (level.vertical) {
      script << "set arrow from first " << value << ",graph 0 to first " << value << ",graph 1" << style;
      if (!level.label.empty()) {
        script << "set label " << words << " at first " << value << ",graph 0.97 left offset 0.5,0 tc rgb '"
               << colour::kAlarm << "' noenhanced front\n";
      }
    } else if (level.value >= range.first && level.value <= range.second) {
      // Outside, gnuplot would draw it across the neighbouring figures.
      script << "set arrow from graph 0,first " << value << " to graph 1,first " << value << style;
      if (!level.label.empty()) {
        script << "set label " << words << " at graph 0.995,first " << value << " right offset 0,0.5 tc rgb '"
               << colour::kAlarm << "' noenhanced front\n";
      }
    }
  }
}

void writeCurves(std::ostream& script, const Figure& figure, const std::string& prefix) {
  for (std::size_t i = 0; i < figure.series.size(); ++i) {
    script << "$" << prefix << i << " << EOD\n";
    writeData(script, figure.series[i]);
    script << "EOD\n";
  }
  const std::pair<double, double> range = verticalRange(figure);
  script << "set yrange " << rangeText(range) << "\n";
  if (!figure.right_label.empty()) {
    script << "set y2label " << quoted(figure.right_label) << " noenhanced offset -1,0\nset y2tics\n"
           << "set y2range " << (figure.right_range ? rangeText(*figure.right_range) : "[*:*]")
           << "\nset border 11\nset rmargin 8\n";
  }
  for (const Shade& shade : figure.shades) {
    script << "set object rectangle from " << formatNumber(shade.from) << ",graph 0 to "
           << formatNumber(shade.to) << ",graph 1 fc rgb '" << shade.colour << "' fs solid noborder behind\n";
  }
  writeLevels(script, figure, range);
  script << "plot ";
  for (std::size_t i = 0; i < figure.series.size(); ++i) {
    script << (i == 0 ? "" : ", ") << plotted(figure.series[i], "$" + prefix + std::to_string(i));
  }
  script << "\n";
}

void writeBars(std::ostream& script, const Figure& figure) {
  const auto top = static_cast<double>(figure.rows.size());
  std::size_t longest = 0;
  for (const std::string& row : figure.rows) {
    longest = std::max(longest, row.size());
  }
  constexpr std::size_t kUsualMargin = 20;
  script << "set yrange [0:" << top << "]\nset lmargin " << std::max(kUsualMargin, longest + 1)
         << "\nset ytics (";
  for (std::size_t row = 0; row < figure.rows.size(); ++row) {
    script << (row == 0 ? "" : ", ") << quoted(figure.rows[row]) << " "
           << top - static_cast<double>(row) - 0.5;
  }
  script << ") noenhanced nomirror\nset grid noy\n";
  for (const Bar& bar : figure.bars) {
    const double middle = top - static_cast<double>(bar.row) - 0.5;
    // A border keeps a bar of a single tick visible.
    script << "set object rectangle from " << formatNumber(bar.from) << "," << middle - 0.32 << " to "
           << formatNumber(bar.to) << "," << middle + 0.32 << " fc rgb '" << bar.colour
           << "' fs solid border rgb '" << bar.colour << "' lw 0.8\n";
  }
  for (const RowMark& mark : figure.row_marks) {
    const double middle = top - static_cast<double>(mark.row) - 0.5;
    script << "set arrow from " << formatNumber(mark.at) << "," << middle - 0.45 << " to "
           << formatNumber(mark.at) << "," << middle + 0.45 << " nohead lw 2 lc rgb '" << mark.colour
           << "' front\n";
  }
  for (const RowNote& note : figure.row_notes) {
    script << "set label " << quoted(note.text) << " at " << formatNumber(note.at) << ","
           << top - static_cast<double>(note.row) - 0.5 << " left offset 0.6,0 noenhanced front\n";
  }
  writeLevels(script, figure, {0.0, top});
  script << "plot 1/0 notitle\n";
}

void writeHistogram(std::ostream& script, const Figure& figure, const std::string& prefix) {
  const Histogram& histogram = *figure.histogram;
  script << "$" << prefix << " << EOD\n";
  for (std::size_t i = 0; i < histogram.centre.size(); ++i) {
    if (histogram.count[i] > 0.0) {
      script << formatNumber(histogram.centre[i]) << " " << formatNumber(histogram.count[i]) << "\n";
    }
  }
  const double half = 0.5 * histogram.width;
  script << "EOD\nset logscale y\nset yrange [0.5:*]\nset format y '10^{%T}'\n"
         << "set xrange [" << formatNumber(histogram.centre.front() - 2.0 * half) << ":"
         << formatNumber(histogram.centre.back() + 2.0 * half) << "]\n"
         << "plot $" << prefix << " using 1:2:(" << formatNumber(half)
         << "*1.9) with boxes fs solid 0.85 noborder lc rgb '" << colour::kBlue << "' notitle\n";
}

void writeFigure(std::ostream& script, const Figure& figure, const std::string& prefix) {
  writeCommon(script, figure);
  if (figure.histogram) {
    writeHistogram(script, figure, prefix);
  } else if (!figure.rows.empty()) {
    writeBars(script, figure);
  } else {
    writeCurves(script, figure, prefix);
  }
}

int heightOf(const Figure& figure) {
  constexpr int kRowHeight = 22;
  return figure.rows.empty() ? kFigureHeight : 115 + kRowHeight * static_cast<int>(figure.rows.size());
}

}  // namespace

std::vector<std::string> drawSvg(std::span<const Figure> figures) {
  const files::TemporaryFolder folder;
  std::ostringstream script;
  script << "set encoding utf8\n";
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const std::string name = "figure" + std::to_string(i + 1);
    script << "set terminal svg name " << quoted(name) << " size "
           << (figures[i].wide ? kWideWidth : kFigureWidth) << "," << heightOf(figures[i])
           << " dynamic enhanced font 'Helvetica,Arial,sans-serif,13'\n"
           << "set output " << quoted((folder / name).string()) << "\n";
    writeFigure(script, figures[i], name + "_");
    script << "unset output\n";
  }
  run(script.str(), folder);
  std::vector<std::string> documents;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const std::string text = app::readFile(folder / ("figure" + std::to_string(i + 1)), files::kResultFile);
    documents.push_back(text.substr(std::min(text.find("<svg"), text.size())));
  }
  return documents;
}

void drawPng(std::span<const Figure> figures, const std::string& title, const std::filesystem::path& path) {
  const files::TemporaryFolder folder;
  const std::string picture = (folder / "overview.png").string();
  constexpr int kTitleHeight = 50;
  // Rows of two figures; a wide one has a row of its own.
  struct Place {
    int x, y, width, height;
  };
  std::vector<Place> places;
  int y = kTitleHeight;
  int column = 0;
  int row_height = 0;
  for (const Figure& figure : figures) {
    const int span = figure.wide ? 2 : 1;
    if (column + span > 2) {
      y += row_height;
      column = 0;
      row_height = 0;
    }
    places.push_back({column * kWideWidth / 2, y, span * kWideWidth / 2, heightOf(figure)});
    row_height = std::max(row_height, heightOf(figure));
    column += span;
  }
  const int height = y + row_height;
  std::ostringstream script;
  script << "set encoding utf8\nset terminal pngcairo size " << kWideWidth << "," << height
         << " enhanced font 'Helvetica,11'\nset output " << quoted(picture) << "\nset multiplot title "
         << quoted(title) << " font ',16' noenhanced\n";
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const Place& place = places[i];
    script << "set origin " << static_cast<double>(place.x) / kWideWidth << ","
           << 1.0 - static_cast<double>(place.y + place.height) / height << "\nset size "
           << static_cast<double>(place.width) / kWideWidth << ","
           << static_cast<double>(place.height) / height << "\n";
    std::ostringstream body;
    writeFigure(body, figures[i], "figure" + std::to_string(i + 1) + "_");
    script << body.str();
  }
  script << "unset multiplot\nunset output\n";
  run(script.str(), folder);
  app::writeFile(path, app::readFile(picture, files::kResultFile));
}

}  // namespace patella::report
