#include "tools/recordings/mapped_recording.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "firmware_app/files/file_error.hpp"
#include "tools/recordings/mat_table.hpp"
#include "tools/recordings/number_table.hpp"

namespace patella::diagnose {
namespace {

std::vector<double> valuesOf(const NumberTable& table, const SignalSource& source) {
  std::vector<double> values(table.rows(), source.offset);
  for (const SignalTerm& term : source.terms) {
    const std::vector<double>& column = table.of(term.column);
    for (std::size_t row = 0; row < values.size(); ++row) {
      values[row] += term.scale * column[row];
    }
  }
  return values;
}

std::vector<double> stampsOf(const NumberTable& table, const ColumnMap& map) {
  std::vector<double> stamps_s(table.rows());
  for (std::size_t row = 0; row < stamps_s.size(); ++row) {
    stamps_s[row] = map.rate_Hz ? static_cast<double>(row) / *map.rate_Hz
                                : map.time_scale_s * table.of(*map.time_column)[row];
  }
  return stamps_s;
}

void fillJoint(const NumberTable& table, const JointColumns& columns, std::size_t joint,
               RawRecording& recording) {
  recording.torque_Nm[joint] = valuesOf(table, columns.torque_Nm);
  recording.start_rad[joint] = columns.start_rad;
  if (columns.position_rad) {
    recording.position_rad[joint] = valuesOf(table, *columns.position_rad);
  }
  if (columns.velocity_rad_s) {
    recording.velocity_rad_s[joint] = valuesOf(table, *columns.velocity_rad_s);
  }
  if (columns.commanded_Nm) {
    recording.commanded_Nm[joint] = valuesOf(table, *columns.commanded_Nm);
  }
}

std::vector<std::size_t> chosenRows(const NumberTable& table, const std::vector<RowChoice>& only) {
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < table.rows(); ++row) {
    if (std::all_of(only.begin(), only.end(),
                    [&](const RowChoice& choice) { return table.of(choice.column)[row] == choice.equals; })) {
      rows.push_back(row);
    }
  }
  return rows;
}

}  // namespace

RawRecording readMappedRecording(const std::filesystem::path& file, int joints, const ColumnMap& map) {
  if (map.joints.size() != static_cast<std::size_t>(joints)) {
    throw app::FileError(
        fmt::format("{}: the map of its columns has {} tables [[joint]], but the model has {}", file.string(),
                    map.joints.size(), joints == 1 ? "one joint" : std::to_string(joints) + " joints"));
  }
  const NumberTable table = isMatFile(file) ? readMatTable(file, map.columns()) : readTextTable(file, map);
  RawRecording recording;
  recording.name = file.string();
  recording.joints = joints;
  recording.torque_timing = map.torque_timing;
  recording.is_static = map.is_static;
  recording.rate_Hz = map.rate_Hz;
  recording.line = table.line;
  recording.warnings = table.warnings;
  if (map.time_column) {
    recording.time_name = map.time_column->text();
  }
  if (!map.is_static) {
    recording.stamp_s = stampsOf(table, map);
  }
  for (std::size_t j = 0; j < map.joints.size(); ++j) {
    fillJoint(table, map.joints[j], j, recording);
  }
  for (std::size_t c = 0; c < map.emg_mV.size(); ++c) {
    recording.emg_mV[c] = valuesOf(table, map.emg_mV[c]);
  }
  for (std::size_t c = 0; c < map.activation.size(); ++c) {
    recording.activation[c] = valuesOf(table, map.activation[c]);
  }
  if (!map.only.empty()) {
    keepRows(recording, chosenRows(table, map.only));
  }
  return recording;
}

}  // namespace patella::diagnose
