#include "tools/recordings/csv_recording.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <utility>

#include <fmt/format.h>

#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/files/wording.hpp"
#include "firmware_app/formats/mcap_reader.hpp"
#include "tools/recordings/column_names.hpp"
#include "tools/recordings/held_torque.hpp"
#include "tools/recordings/mcap_table.hpp"
#include "tools/recordings/number_table.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

using app::CsvTable;
using app::FileError;

constexpr const char* kStepsColumn = "encoder_steps";
constexpr std::string_view kOtherwise = "; otherwise, expected a map of the columns (--columns)";

std::string firstLine(const std::filesystem::path& file) {
  return formats::isMcap(file) ? mcapColumns(file) : firstLineOf(file);
}

std::string numbered(const char* stem, std::size_t index, const char* ending) {
  return std::string(stem) + std::to_string(index + 1) + ending;
}

/// Reads the columns that are asked for, and no others, which may hold text.
class NamedColumns {
 public:
  explicit NamedColumns(const std::filesystem::path& file)
      : file_(file), header_(namesIn(firstLine(file), file.string())) {}

  bool has(const std::string& column) const {
    return std::find(header_.begin(), header_.end(), column) != header_.end();
  }
  /// First of the names that the file has.
  std::string firstOf(std::initializer_list<std::string> names) const {
    const auto found = std::find_if(names.begin(), names.end(), [&](const auto& n) { return has(n); });
    return found == names.end() ? std::string() : *found;
  }
  void want(const std::string& column) { wanted_.push_back(column); }
  CsvTable read(std::string_view remedy) {
    requireColumns(file_.string(), header_, wanted_, {.remedy = remedy});
    const app::CsvOptions options{.columns = wanted_, .allow_missing = true, .allow_cut_off = true};
    if (!formats::isMcap(file_)) {
      return CsvTable::load(file_, options);
    }
    McapTable table = loadMcapTable(file_, options);
    cut_off_ = table.cut_off;
    return std::move(table.ticks);
  }
  /// Whether read() found a file of which the end is missing, beyond its last line.
  bool cutOff() const noexcept { return cut_off_; }

 private:
  std::filesystem::path file_;
  std::vector<std::string> header_;
  std::vector<std::string> wanted_;
  bool cut_off_ = false;
};

std::vector<double> copyOf(const CsvTable& table, const std::string& column) {
  const auto values = table.column(column);
  return {values.begin(), values.end()};
}

void requireJoints(const NamedColumns& columns, const std::string& name, int joints) {
  const std::string beyond = numbered("q", static_cast<std::size_t>(joints), "_rad");
  if (columns.has(beyond)) {
    throw FileError(name + ":1: there is a column '" + beyond + "', but the model has " +
                    (joints == 1 ? "one joint" : std::to_string(joints) + " joints"));
  }
}

void numberLines(RawRecording& recording) {
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    recording.line.push_back(CsvTable::lineOf(row));
  }
}

/// A velocity is of use only where every position has one; a row is not lost for the want of it.
void dropIncompleteVelocity(RawRecording& recording) {
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    const std::vector<double>& velocity = recording.velocity_rad_s[j];
    for (std::size_t row = 0; row < velocity.size(); ++row) {
      if (std::isnan(velocity[row]) && !std::isnan(recording.position_rad[j][row])) {
        recording.velocity_rad_s = {};
        return;
      }
    }
  }
}

/// Which columns of a table are the signals, beyond those that every table has.
struct SignalColumns {
  bool has_velocity = true;
  bool has_activation = false;
  std::array<std::string, kMaxJoints> commanded;
  std::array<std::string, kMaxEmgChannels> emg;  ///< raw, or activation
};

SignalColumns wantSignals(NamedColumns& columns, std::size_t joints) {
  SignalColumns found;
  columns.want("t_s");
  for (std::size_t j = 0; j < joints; ++j) {
    found.has_velocity = found.has_velocity && columns.has(numbered("dq", j, "_rad_s"));
  }
  for (std::size_t j = 0; j < joints; ++j) {
    if (found.has_velocity) {
      columns.want(numbered("dq", j, "_rad_s"));
    }
    columns.want(numbered("q", j, "_rad"));
    columns.want(numbered("tau", j, "_Nm"));
    found.commanded[j] = columns.firstOf({numbered("tau_cmd", j, "_Nm"), numbered("tau", j, "_cmd_Nm")});
    if (!found.commanded[j].empty()) {
      columns.want(found.commanded[j]);
    }
  }
  found.has_activation = columns.has("activation1");
  for (std::size_t c = 0; c < kMaxEmgChannels; ++c) {
    const std::string column =
        found.has_activation ? numbered("activation", c, "") : numbered("emg", c, "_mV");
    if (columns.has(column)) {
      found.emg[c] = column;
      columns.want(column);
    }
  }
  return found;
}

/// To be called before rows are left out.
void noteCut(RawRecording& recording) {
  recording.cut_off =
      fmt::format("the file is cut off, and was read up to {:.6g} s", recording.stamp_s.back());
  recording.warnings.push_back(recording.cut_off);
}

/// Named signals of a table; `extra` columns are read for the caller.
CsvTable readSignals(const std::filesystem::path& file, RawRecording& recording,
                     std::initializer_list<const char*> extra) {
  NamedColumns columns(file);
  const auto joints = static_cast<std::size_t>(recording.joints);
  requireJoints(columns, recording.name, recording.joints);
  const SignalColumns found = wantSignals(columns, joints);
  for (const char* column : extra) {
    if (columns.has(column)) {
      columns.want(column);
    }
  }
  CsvTable table = columns.read(kOtherwise);
  warnOfCutOff(recording.warnings, recording.name, table.cutOffLine());
  recording.stamp_s = table.take("t_s");
  if (columns.cutOff()) {
    noteCut(recording);
  }
  for (std::size_t j = 0; j < joints; ++j) {
    recording.position_rad[j] = table.take(numbered("q", j, "_rad"));
    recording.torque_Nm[j] = table.take(numbered("tau", j, "_Nm"));
    if (!found.commanded[j].empty()) {
      recording.commanded_Nm[j] = table.take(found.commanded[j]);
    }
    if (found.has_velocity) {
      recording.velocity_rad_s[j] = table.take(numbered("dq", j, "_rad_s"));
    }
  }
  dropIncompleteVelocity(recording);
  for (std::size_t c = 0; c < kMaxEmgChannels; ++c) {
    if (!found.emg[c].empty()) {
      (found.has_activation ? recording.activation : recording.emg_mV)[c] = table.take(found.emg[c]);
    }
  }
  numberLines(recording);
  return table;
}

/// f_u as a simulated rig published it. A tick that it came too late for has that of the tick before.
void readTruth(const std::filesystem::path& file, RawRecording& recording) {
  const auto joints = static_cast<std::size_t>(recording.joints);
  NamedColumns columns(file);
  for (std::size_t j = 0; j < joints; ++j) {
    columns.want(numbered("f_true", j, "_rad_s2"));
  }
  CsvTable table = columns.read(", expected those of a simulated rig (rig.publish_truth)");
  for (std::size_t j = 0; j < joints; ++j) {
    std::vector<double> truth = table.take(numbered("f_true", j, "_rad_s2"));
    const auto first = std::find_if(truth.begin(), truth.end(), [](double v) { return std::isfinite(v); });
    if (first == truth.end()) {
      throw FileError(recording.name + ": column '" + numbered("f_true", j, "_rad_s2") +
                      "' has no value, expected what a simulated rig publishes (rig.publish_truth)");
    }
    double last = *first;
    for (double& value : truth) {
      last = std::isfinite(value) ? value : last;
      value = last;
    }
    recording.unknown_rad_s2[j] = std::move(truth);
  }
}

bool neverMoves(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return v == 0.0 || std::isnan(v); });
}

bool reportsNoTorque(const RawRecording& recording) {
  for (std::size_t j = 0; j < static_cast<std::size_t>(recording.joints); ++j) {
    if (!neverMoves(recording.torque_Nm[j]) || recording.commanded_Nm[j].empty()) {
      return false;
    }
  }
  return std::any_of(recording.commanded_Nm.begin(), recording.commanded_Nm.end(),
                     [](const auto& commanded) { return !neverMoves(commanded); });
}

double medianLatency_s(const CsvTable& table) {
  constexpr const char* kColumn = "latency_us";
  if (!table.has(kColumn)) {
    return 0.0;
  }
  std::vector<double> known = copyOf(table, kColumn);
  std::erase_if(known, [](double value) { return std::isnan(value); });
  return known.empty() ? 0.0 : 1e-6 * offline::median(known);
}

}  // namespace

bool isLoopTable(const std::filesystem::path& file) {
  return firstLine(file).find(kStepsColumn) != std::string::npos;
}

RawRecording readNamedColumns(const std::filesystem::path& file, int joints) {
  RawRecording recording;
  recording.name = file.string();
  recording.joints = joints;
  recording.torque_timing_assumed = true;
  readSignals(file, recording, {});
  return recording;
}

RawRecording readLoopTable(const std::filesystem::path& file, int joints, bool sampled, bool with_truth) {
  const std::string name = file.string();
  RawRecording recording;
  recording.name = name;
  recording.joints = joints;
  const CsvTable table = readSignals(file, recording, {kStepsColumn, "latency_us"});
  if (reportsNoTorque(recording)) {
    takeCommandsAsApplied(recording);
  }
  if (with_truth) {
    readTruth(file, recording);
  }
  // A tick without a new sample of all joints repeats the one before it.
  const auto steps = table.column(kStepsColumn);
  std::vector<std::size_t> sampled_rows;
  std::vector<double> count;
  double samples = 0.0;
  for (std::size_t row = 0; row < recording.rows(); ++row) {
    if (steps[row] > 0.0 && std::isfinite(recording.position_rad[0][row])) {
      samples += sampled_rows.empty() ? 0.0 : steps[row];
      sampled_rows.push_back(row);
      count.push_back(samples);
    }
  }
  if (sampled_rows.size() < 2) {
    throw FileError(name + ": " + std::to_string(sampled_rows.size()) +
                    " rows with an encoder sample, expected a recorded motion" +
                    (recording.cut_off.empty() ? "" : "; " + recording.cut_off));
  }
  keepRows(recording, sampled_rows);
  const double start_s = recording.stamp_s.front();
  const double period_s = (recording.stamp_s.back() - start_s) / samples;
  if (!(period_s > 0.0)) {
    throw FileError(name + ":" + std::to_string(recording.line.back()) + ": time " +
                    app::formatNumber(recording.stamp_s.back()) + " s at the end, expected more than " +
                    app::formatNumber(start_s) + " s as at the beginning");
  }
  for (std::size_t row = 0; row < count.size(); ++row) {
    recording.stamp_s[row] = start_s + count[row] * period_s;
  }
  recording.rate_Hz = 1.0 / period_s;
  if (sampled) {
    recording.torque_timing = TorqueTiming::kSampled;
  } else {
    alignHeldTorque(recording, medianLatency_s(table) / period_s);
  }
  return recording;
}

}  // namespace patella::diagnose
