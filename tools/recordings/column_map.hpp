// Which columns of a foreign CSV are the signals of a recording.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// value = scale · column + offset; without a column it is the offset throughout.
struct ColumnSource {
  std::string column;
  double scale = 1.0;
  double offset = 0.0;
};

struct JointColumns {
  ColumnSource position_rad;
  ColumnSource torque_Nm;
  std::optional<ColumnSource> commanded_Nm;
};

/// Only rows in which the column has this value belong to the recording.
struct RowChoice {
  std::string column;
  double equals = 0.0;
};

struct ColumnMap {
  char delimiter = ',';
  bool is_static = false;  ///< postures at rest: no time column
  std::string time_column;
  double time_scale_s = 1.0;  ///< seconds per unit of that column
  TorqueTiming torque_timing = TorqueTiming::kHeld;
  std::vector<JointColumns> joints;
  std::vector<ColumnSource> emg_mV;
  std::vector<ColumnSource> activation;
  std::vector<RowChoice> only;

  /// Every column that is needed, once.
  std::vector<std::string> columns() const;
};

/// Reads a map. Throws app::FileError located in it.
ColumnMap loadColumnMap(const std::filesystem::path& path);
/// `name` stands for the file in messages.
ColumnMap parseColumnMap(std::string_view text, const std::string& name);

}  // namespace patella::diagnose
