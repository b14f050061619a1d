// Which columns of a foreign file are the signals of a recording.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tools/recordings/recording.hpp"
#include "tools/recordings/signal_source.hpp"

namespace patella::diagnose {

struct JointColumns {
  std::optional<SignalSource> position_rad;
  std::optional<SignalSource> velocity_rad_s;
  /// Where the motion starts that is the integral of the velocity; only without a position.
  std::optional<double> start_rad;
  SignalSource torque_Nm;
  std::optional<SignalSource> commanded_Nm;
};

/// Only rows in which the column has this value belong to the recording.
struct RowChoice {
  FileColumn column;
  double equals = 0.0;
};

struct ColumnMap {
  char delimiter = ',';  ///< of text; a space stands for any run of spaces and tabs
  ColumnNaming naming = ColumnNaming::kNames;
  bool is_static = false;  ///< postures at rest: neither time column nor rate
  std::optional<FileColumn> time_column;
  double time_scale_s = 1.0;      ///< seconds per unit of that column
  std::optional<double> rate_Hz;  ///< of a file without a time column
  TorqueTiming torque_timing = TorqueTiming::kHeld;
  std::vector<JointColumns> joints;
  std::vector<SignalSource> emg_mV;
  std::vector<SignalSource> activation;
  std::vector<RowChoice> only;

  /// Every column that is needed, once.
  std::vector<FileColumn> columns() const;
};

/// Reads a map. Throws app::FileError located in it.
ColumnMap loadColumnMap(const std::filesystem::path& path);
/// `name` stands for the file in messages.
ColumnMap parseColumnMap(std::string_view text, const std::string& name);

}  // namespace patella::diagnose
