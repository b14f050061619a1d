#include "tools/report/gnuplot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <sstream>
#include <stdexcept>

#include <sys/wait.h>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::report {
namespace {

using app::formatNumber;

constexpr int kFigureHeight = 300;
constexpr int kFigureWidth = 760;
constexpr int kWideWidth = 1540;

/// A folder that goes away with its pictures.
class PictureFolder {
 public:
  PictureFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "patella-report-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) {
      throw std::runtime_error(name + ": cannot be created");
    }
    path_ = name;
  }
  ~PictureFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  PictureFolder(const PictureFolder&) = delete;
  PictureFolder& operator=(const PictureFolder&) = delete;

  std::string file(const std::string& name) const { return (path_ / name).string(); }

 private:
  std::filesystem::path path_;
};

void run(const std::string& script) {
  FILE* gnuplot = popen("gnuplot -", "w");
  if (gnuplot == nullptr) {
    throw std::runtime_error("gnuplot cannot be started");
  }
  const bool written = std::fwrite(script.data(), 1, script.size(), gnuplot) == script.size();
  const int status = pclose(gnuplot);
  constexpr int kCommandNotFound = 127;
  if (WIFEXITED(status) && WEXITSTATUS(status) == kCommandNotFound) {
    throw std::runtime_error("gnuplot is not installed (Debian package gnuplot-nox)");
  }
  if (!written || status != 0) {
    throw std::runtime_error("gnuplot failed; its own message stands above");
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
    if (std::isfinite(value)) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  };
  for (const Series& series : figure.series) {
    if (!series.right_axis) {
      std::for_each(series.y.begin(), series.y.end(), include);
    }
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
         << "set ytics auto nomirror enhanced\nset xtics nomirror\nset format y '%g'\n"
         << "set border 3 lc rgb '#777777'\nset grid x y lc rgb '#E4E4E4' lt 1 lw 0.6\n"
         << "set lmargin 9\nset rmargin 4\nset tmargin 3.2\nset bmargin 3\n"
         << "set key at graph 1,graph 1.03 right bottom horizontal samplen 1.6 noenhanced\n";
  if (figure.x_range && figure.x_range->first < figure.x_range->second) {
    script << "set xrange " << rangeText(*figure.x_range) << "\n";
  } else {
    script << "set xrange [*:*]\n";
  }
}

void writeCurves(std::ostream& script, const Figure& figure, const std::string& prefix) {
  for (std::size_t i = 0; i < figure.series.size(); ++i) {
    const Series& series = figure.series[i];
    script << "$" << prefix << i << " << EOD\n";
    for (std::size_t k = 0; k < series.x.size(); ++k) {
      if (std::isfinite(series.y[k])) {
        std::array<char, 64> line{};
        std::snprintf(line.data(), line.size(), "%.7g %.5g\n", series.x[k], series.y[k]);
        script << line.data();
      } else {
        script << "\n";
      }
    }
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
  for (const Level& level : figure.levels) {
    if (level.value < range.first || level.value > range.second) {
      continue;  // gnuplot would draw it across the neighbouring figures
    }
    const std::string value = formatNumber(level.value);
    script << "set arrow from graph 0,first " << value << " to graph 1,first " << value
           << " nohead dt (6,4) lw 1 lc rgb '#B00020' front\n";
    if (!level.label.empty()) {
      script << "set label " << quoted(level.label) << " at graph 0.995,first " << value
             << " right offset 0,0.5 tc rgb '#B00020' noenhanced front\n";
    }
  }
  script << "plot ";
  for (std::size_t i = 0; i < figure.series.size(); ++i) {
    const Series& series = figure.series[i];
    script << (i == 0 ? "" : ", ") << "$" << prefix << i << " using 1:2 with "
           << (series.steps ? "steps" : "lines") << (series.right_axis ? " axes x1y2" : "") << " lc rgb '"
           << series.colour << "' lw " << series.width << (series.dashed ? " dt (8,4)" : " dt 1") << " title "
           << quoted(series.label);
  }
  script << "\n";
}

void writeBars(std::ostream& script, const Figure& figure) {
  const auto top = static_cast<double>(figure.rows.size());
  script << "set yrange [0:" << top << "]\nset lmargin 20\nset ytics (";
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
         << "*1.9) with boxes fs solid 0.85 noborder lc rgb '#0072B2' notitle\n";
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
  return figure.rows.empty() ? kFigureHeight : 90 + kRowHeight * static_cast<int>(figure.rows.size());
}

}  // namespace

std::vector<std::string> drawSvg(std::span<const Figure> figures) {
  const PictureFolder folder;
  std::ostringstream script;
  script << "set encoding utf8\n";
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const std::string name = "figure" + std::to_string(i + 1);
    script << "set terminal svg name " << quoted(name) << " size "
           << (figures[i].wide ? kWideWidth : kFigureWidth) << "," << heightOf(figures[i])
           << " dynamic enhanced font 'Helvetica,Arial,sans-serif,13'\n"
           << "set output " << quoted(folder.file(name)) << "\n";
    writeFigure(script, figures[i], name + "_");
    script << "unset output\n";
  }
  run(script.str());
  std::vector<std::string> documents;
  for (std::size_t i = 0; i < figures.size(); ++i) {
    const std::string text = app::readFile(folder.file("figure" + std::to_string(i + 1)));
    documents.push_back(text.substr(std::min(text.find("<svg"), text.size())));
  }
  return documents;
}

void drawPng(std::span<const Figure> figures, const std::string& title, const std::filesystem::path& path) {
  const PictureFolder folder;
  const std::string picture = folder.file("overview.png");
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
  run(script.str());
  app::writeFile(path, app::readFile(picture));
}

}  // namespace patella::report
