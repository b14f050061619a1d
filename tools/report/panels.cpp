#include "tools/report/panels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include <nlohmann/json.hpp>

#include "core/safety/fault.hpp"
#include "core/safety/state_machine.hpp"
#include "core/types.hpp"
#include "tools/report/palette.hpp"
#include "tools/report/reduction.hpp"
#include "tools/report/summary_values.hpp"

namespace patella::report {
namespace {

using namespace colour;

constexpr std::size_t kBins = 700;  // about the width of a figure in pixels

/// Chooses columns and rows of a run and turns them into curves.
class Curves {
 public:
  explicit Curves(const app::CsvTable& ticks) : ticks_(ticks), time_(ticks.column("t_s")) {}

  std::span<const double> time() const { return time_; }
  bool has(const std::string& name) const {
    if (!ticks_.has(name)) {
      return false;
    }
    const auto values = ticks_.column(name);
    return std::any_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
  }
  /// Present, and not zero throughout.
  bool alive(const std::string& name) const {
    return has(name) && std::any_of(ticks_.column(name).begin(), ticks_.column(name).end(),
                                    [](double value) { return std::isfinite(value) && value != 0.0; });
  }
  std::span<const double> column(const std::string& name) const { return ticks_.column(name); }

  /// Adds the column to the figure as `style` has it, if the run has it; rows [first, last).
  void add(Figure& figure, const std::string& name, Series style, std::size_t first, std::size_t last) const {
    if (has(name)) {
      addEnvelope(style, time_.subspan(first, last - first), column(name).subspan(first, last - first),
                  kBins);
      figure.series.push_back(std::move(style));
    }
  }
  void add(Figure& figure, const std::string& name, Series style) const {
    add(figure, name, std::move(style), 0, time_.size());
  }

  /// Adds one column less another; the mean of its absolute values stands behind the label.
  void addDifference(Figure& figure, const std::string& name, const std::string& from, Series style) const {
    const std::span<const double> minuend = column(name);
    const std::span<const double> subtrahend = column(from);
    std::vector<double> difference(minuend.size());
    double sum = 0.0;
    double count = 0.0;
    for (std::size_t i = 0; i < difference.size(); ++i) {
      difference[i] = minuend[i] - subtrahend[i];
      sum += std::isfinite(difference[i]) ? std::abs(difference[i]) : 0.0;
      count += std::isfinite(difference[i]) ? 1.0 : 0.0;
    }
    std::array<char, 32> mean{};
    std::snprintf(mean.data(), mean.size(), " %.3g", count > 0.0 ? sum / count : 0.0);
    style.label += mean.data();
    addEnvelope(style, time_, difference, kBins);
    figure.series.push_back(std::move(style));
  }

 private:
  const app::CsvTable& ticks_;
  std::span<const double> time_;
};

Series line(const std::string& label, const char* colour, double width = 1.3) {
  Series series;
  series.label = label;
  series.colour = colour;
  series.width = width;
  return series;
}

std::string jointName(int joint) {
  return "joint " + std::to_string(joint);
}

std::string column(const char* stem, int index, const char* unit) {
  return std::string(stem) + std::to_string(index) + unit;
}

std::vector<Level> torqueLimits(const nlohmann::json& summary, int joint) {
  const nlohmann::json* limit = findKey(summary, "torque_limit_Nm");
  if (limit != nullptr && limit->is_array() && limit->size() >= static_cast<std::size_t>(joint)) {
    limit = &(*limit)[static_cast<std::size_t>(joint) - 1];
  }
  if (limit == nullptr || !limit->is_number()) {
    return {};
  }
  return {{limit->get<double>(), "limit", false}, {-limit->get<double>(), "", false}};
}

/// Where torque was stopped or held back, as background of the time charts.
std::vector<Shade> shades(const Curves& curves) {
  std::vector<Shade> result;
  const auto add = [&](const char* name, const char* colour) {
    if (!curves.has(name)) {
      return;
    }
    std::vector<double> set(curves.time().size());
    const auto bits = curves.column(name);
    std::transform(bits.begin(), bits.end(), set.begin(),
                   [](double value) { return value > 0.0 ? 1.0 : 0.0; });
    for (const auto& [from, to] : bitStretches(curves.time(), set, 0)) {
      result.push_back({from, to, colour});
    }
  };
  add("limits", kLimitShade);
  add("faults", kFaultShade);
  // Flicker of single ticks over a long run would be thousands of rectangles and show nothing.
  constexpr std::size_t kMost = 400;
  if (result.size() > kMost) {
    std::nth_element(result.begin(), result.begin() + kMost, result.end(),
                     [](const Shade& a, const Shade& b) { return a.to - a.from > b.to - b.from; });
    result.resize(kMost);
  }
  return result;
}

void addAngles(const Curves& curves, int joint, std::vector<Figure>& figures) {
  Figure figure;
  figure.section = "Motion";
  figure.title = "Angle, " + jointName(joint);
  figure.y_label = "rad";
  curves.add(figure, column("ref", joint, "_rad"), line("reference", kBlack, 1.8));
  if (!figure.series.empty()) {
    figure.series.back().dashed = true;
  }
  curves.add(figure, column("q", joint, "_rad"), line("measured", kBlue));
  figures.push_back(std::move(figure));
}

void addTorque(const Curves& curves, const nlohmann::json& summary, int joint, std::vector<Figure>& figures) {
  Figure figure;
  figure.section = "Torque";
  figure.title = "Torque, " + jointName(joint);
  figure.y_label = "N·m";
  curves.add(figure, column("tau", joint, "_Nm"), line("applied by the drive", kSky, 2.0));
  curves.add(figure, column("tau_cmd", joint, "_Nm"), line("commanded", kRed));
  figure.levels = torqueLimits(summary, joint);
  figures.push_back(std::move(figure));

  Figure terms;
  terms.section = "Torque";
  terms.title = "Torque terms, " + jointName(joint);
  terms.y_label = "N·m";
  const std::pair<const char*, std::pair<const char*, const char*>> kTerms[] = {
      {"tau_gravity", {"gravity", kGrey}},
      {"tau_model", {"model", kBlack}},
      {"tau_emg", {"EMG", kGreen}},
      {"tau_impedance", {"impedance", kBlue}},
      {"tau_compensation", {"compensation", kPurple}}};
  for (const auto& [stem, style] : kTerms) {
    if (curves.alive(column(stem, joint, "_Nm"))) {
      curves.add(terms, column(stem, joint, "_Nm"), line(style.first, style.second));
    }
  }
  figures.push_back(std::move(terms));
}

void addUnknownCurves(const Curves& curves, int joint, Figure& figure, std::size_t first, std::size_t last) {
  curves.add(figure, column("f_true", joint, "_rad_s2"), line("truth", kGrey, 3.5), first, last);
  curves.add(figure, column("f_s", joint, "_rad_s2"), line("sampler", kSky), first, last);
  curves.add(figure, column("f_s_filtered", joint, "_rad_s2"), line("sampler, filtered", kBlue), first, last);
  if (curves.alive(column("f_network", joint, "_rad_s2"))) {
    curves.add(figure, column("f_network", joint, "_rad_s2"), line("network", kRed), first, last);
  }
}

/// Errors of the observer and of the network where the run has a network and knows the truth, with their
/// means.
void addErrors(const Curves& curves, int joint, std::vector<Figure>& figures) {
  const std::string truth = column("f_true", joint, "_rad_s2");
  if (!curves.has(truth) || !curves.alive(column("f_network", joint, "_rad_s2"))) {
    return;
  }
  Figure figure;
  figure.section = "Unknown dynamics";
  figure.title = "Error of f_u, " + jointName(joint);
  figure.y_label = "rad/s² (key: mean)";
  const std::pair<const char*, std::pair<const char*, const char*>> kEstimates[] = {
      {"f_s", {"sampler", kSky}}, {"f_s_filtered", {"filtered", kBlue}}, {"f_network", {"network", kRed}}};
  for (const auto& [stem, style] : kEstimates) {
    if (const std::string name = column(stem, joint, "_rad_s2"); curves.has(name)) {
      curves.addDifference(figure, name, truth, line(style.first, style.second));
    }
  }
  figures.push_back(std::move(figure));
}

/// The second in which the column is largest while torque flows; the first second, while estimators settle,
/// is passed over.
std::pair<std::size_t, std::size_t> liveliestSecond(const Curves& curves, std::span<const double> values) {
  const std::span<const double> time = curves.time();
  const std::span<const double> state =
      curves.has("state") ? curves.column("state") : std::span<const double>();
  const auto idle = [&](std::size_t i) {
    return !state.empty() && state[i] != static_cast<double>(safety::State::kActive);
  };
  std::vector<double> square(time.size() + 1, 0.0);
  for (std::size_t i = 0; i < time.size(); ++i) {
    const double value = std::isfinite(values[i]) && !idle(i) ? values[i] : 0.0;
    square[i + 1] = square[i] + value * value;
  }
  constexpr double kWindow_s = 1.0;
  const auto at = [&](double instant) {
    return static_cast<std::size_t>(std::lower_bound(time.begin(), time.end(), instant) - time.begin());
  };
  std::pair<std::size_t, std::size_t> best{0, at(time.front() + kWindow_s)};
  double most = -1.0;
  for (double from = time.front() + kWindow_s; from + kWindow_s <= time.back(); from += kWindow_s / 4) {
    const auto first = at(from);
    const auto last = at(from + kWindow_s);
    if (square[last] - square[first] > most) {
      most = square[last] - square[first];
      best = {first, last};
    }
  }
  return best;
}

void addUnknown(const Curves& curves, int joint, std::vector<Figure>& figures) {
  Figure whole;
  whole.section = "Unknown dynamics";
  whole.title = "Unknown f_u, " + jointName(joint);
  whole.y_label = "rad/s²";
  addUnknownCurves(curves, joint, whole, 0, curves.time().size());

  Figure zoom = whole;
  zoom.series.clear();
  zoom.title = "f_u, " + jointName(joint) + ", 1 s";
  for (const char* stem : {"f_true", "f_s_filtered", "f_s"}) {
    if (const std::string name = column(stem, joint, "_rad_s2"); curves.has(name)) {
      const auto [first, last] = liveliestSecond(curves, curves.column(name));
      addUnknownCurves(curves, joint, zoom, first, last);
      zoom.x_range = {curves.time()[first], curves.time()[std::max(last, first + 1) - 1]};
      break;
    }
  }
  figures.push_back(std::move(whole));
  figures.push_back(std::move(zoom));
  addErrors(curves, joint, figures);
}

void addEmg(const Curves& curves, int channel, std::vector<Figure>& figures) {
  const std::string raw = column("emg", channel, "_mV");
  if (!curves.alive(raw)) {
    return;
  }
  Figure figure;
  figure.section = "EMG";
  figure.title = "EMG channel " + std::to_string(channel);
  figure.y_label = "mV";
  curves.add(figure, raw, line("raw", kGrey, 0.8));
  for (const char* stem : {"activation", "act"}) {
    if (const std::string name = column(stem, channel, ""); curves.has(name) && figure.right_label.empty()) {
      Series series = line("activation", kGreen, 2.0);
      series.right_axis = true;
      curves.add(figure, name, std::move(series));
      figure.right_label = "activation";
      figure.right_range = {0.0, 1.0};
    }
  }
  figures.push_back(std::move(figure));
}

void addTimeline(const Curves& curves, std::vector<Figure>& figures) {
  Figure figure;
  figure.section = "State and faults";
  figure.title = "State, and what stopped or limited the torque";
  figure.wide = true;
  figure.x_range = {curves.time().front(), curves.time().back()};
  if (curves.has("state")) {
    constexpr const char* kStateColours[] = {kGrey, kSky, kGreen, kOrange, kRed};
    for (int state = 0; state < safety::kStateCount; ++state) {
      figure.rows.emplace_back(safety::stateName(static_cast<safety::State>(state)));
    }
    for (const Stretch& stretch : stretches(curves.time(), curves.column("state"))) {
      if (stretch.value >= 0.0 && stretch.value < safety::kStateCount) {
        const auto row = static_cast<std::size_t>(stretch.value);
        figure.bars.push_back({row, stretch.from, stretch.to, kStateColours[row]});
      }
    }
  }
  if (curves.alive("faults")) {
    for (int fault = 0; fault < safety::kFaultCount; ++fault) {
      const auto spans = bitStretches(curves.time(), curves.column("faults"), static_cast<unsigned>(fault));
      for (const auto& [from, to] : spans) {
        figure.bars.push_back({figure.rows.size(), from, to, kRed});
      }
      if (!spans.empty()) {
        figure.rows.emplace_back(safety::faultName(static_cast<safety::Fault>(fault)));
      }
    }
  }
  figures.push_back(std::move(figure));
}

/// A column of durations, and what the summary has of the same ones.
struct Timing {
  const char* column;
  const char* key;
  const char* title;
};

void addTiming(const Curves& curves, const nlohmann::json& summary, const Timing& timing,
               std::vector<Figure>& figures) {
  if (!curves.has(timing.column)) {
    return;
  }
  const auto values = curves.column(timing.column);
  if (!(percentile(values, 1.0) > 0.0)) {
    return;  // virtual time: nothing takes any
  }
  Figure figure;
  figure.section = "Timing";
  constexpr std::size_t kHistogramBins = 80;
  figure.histogram = histogramOf(values, kHistogramBins);
  figure.title = timing.title + quantilesText(values, summary, timing.key);
  figure.x_label = figure.histogram->open_ended ? "µs (the last bar holds all above)" : "µs";
  figure.y_label = "ticks";
  figures.push_back(std::move(figure));
}

}  // namespace

std::vector<Figure> makePanels(const app::CsvTable& ticks, const nlohmann::json& summary) {
  const Curves curves(ticks);
  std::vector<Figure> figures;
  const auto each_joint = [&](auto&& add) {
    for (int joint = 1; joint <= kMaxJoints; ++joint) {
      add(joint);
    }
  };
  each_joint([&](int joint) { addAngles(curves, joint, figures); });
  each_joint([&](int joint) { addTorque(curves, summary, joint, figures); });
  each_joint([&](int joint) { addUnknown(curves, joint, figures); });
  for (int channel = 1; channel <= kMaxEmgChannels; ++channel) {
    addEmg(curves, channel, figures);
  }
  const std::vector<Shade> background = shades(curves);
  for (Figure& figure : figures) {
    figure.shades = background;
    figure.zoom = figure.right_label.empty();
    if (!figure.x_range) {
      figure.x_range = {curves.time().front(), curves.time().back()};
    }
  }
  addTimeline(curves, figures);
  for (const Timing& timing : {Timing{"wakeup_us", "wakeup_latency", "Wake-up latency"},
                               Timing{"execution_us", "execution", "Execution"},
                               Timing{"latency_us", "sensor_to_torque", "Sensor to torque command"}}) {
    addTiming(curves, summary, timing, figures);
  }
  std::erase_if(figures, [](const Figure& figure) {
    return figure.series.empty() && figure.bars.empty() && !figure.histogram;
  });
  return figures;
}

}  // namespace patella::report
