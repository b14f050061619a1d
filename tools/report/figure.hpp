// A drawing in plain data, before anything is known of the program that draws it.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace patella::report {

/// A curve; a NaN in y breaks it.
struct Series {
  std::string label;
  std::string colour;
  std::vector<double> x;
  std::vector<double> y;
  double width = 1.3;
  bool dashed = false;
  bool steps = false;
  bool right_axis = false;
  bool points = false;          ///< dots of this width instead of a curve
  std::vector<double> error{};  ///< half lengths of error bars, drawn with marks on the curve; empty: none
};

/// A level across the whole width: a limit, a percentile.
struct Level {
  double value = 0.0;
  std::string label;
  bool vertical = false;
};

/// A coloured stretch of the x axis.
struct Shade {
  double from = 0.0;
  double to = 0.0;
  std::string colour;
};

/// A horizontal bar in a row of a chart whose rows are names.
struct Bar {
  std::size_t row = 0;
  double from = 0.0;
  double to = 0.0;
  std::string colour;
};

/// A short upright line in a row of such a chart: a threshold, an estimate.
struct RowMark {
  std::size_t row = 0;
  double at = 0.0;
  std::string colour;
};

/// Words in a row of such a chart, beginning at x.
struct RowNote {
  std::size_t row = 0;
  double at = 0.0;
  std::string text;
};

struct Histogram {
  std::vector<double> centre;
  std::vector<double> count;
  double width = 1.0;
  bool open_ended = false;  ///< the last bar holds what is above it, too
};

struct Figure {
  std::string section;
  std::string title;
  std::string x_label = "time / s";
  std::string y_label;
  std::string right_label;  ///< empty: no right axis
  std::optional<std::pair<double, double>> x_range;
  std::optional<std::pair<double, double>> right_range;
  std::vector<Series> series;
  std::vector<Level> levels;
  std::vector<Shade> shades;
  std::vector<std::string> rows;  ///< names of the rows of a bar chart, from the top
  std::vector<Bar> bars;
  std::vector<RowMark> row_marks;
  std::vector<RowNote> row_notes;
  std::optional<Histogram> histogram;
  std::vector<double> x_ticks;  ///< empty: where the drawing program likes them
  bool log_x = false;
  bool log_y = false;
  bool wide = false;  ///< takes the whole width of the page
  /// Curves of the left axis, without steps, dots and error bars, that a page lets its reader look into.
  bool zoom = false;
};

}  // namespace patella::report
