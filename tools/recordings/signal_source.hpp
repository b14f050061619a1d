// One signal of a recording, made of columns of a file as a map says.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "firmware_app/files/toml_table.hpp"
#include "tools/recordings/units.hpp"

namespace patella::diagnose {

/// A column of a file: by its name, by its number from 1 where columns have no names, or by the name of a
/// matrix and its number in it.
struct FileColumn {
  std::string name;
  std::size_t index = 0;  ///< in the matrix `name`, from 1; 0 where `name` is no matrix

  bool operator==(const FileColumn&) const = default;
  /// "t_s", or "data(:,2)" of a matrix.
  std::string text() const;
};

struct SignalTerm {
  FileColumn column;
  double scale = 1.0;
};

/// value = Σ scale · column + offset; without terms it is the offset throughout.
struct SignalSource {
  std::vector<SignalTerm> terms;
  double offset = 0.0;
};

enum class ColumnNaming {
  kNames,
  kNumbers,  ///< the file has no header
};

/// Reads the keys `column` and `index`, either behind a prefix. Throws app::FileError located in the map, as
/// the others do.
FileColumn readColumn(const app::TomlTable& table, ColumnNaming naming, const std::string& prefix = {});

/// Reads the unit at `key`, the quantity's own where it is absent, as its factor.
double readUnit(const app::TomlTable& table, Quantity quantity, const char* key = "unit");

/// Reads a signal in the unit of the recording: a column with `scale` and `offset`, or a `sum` of columns.
/// A torque may be a current times `torque_constant_Nm_A` and `gear`.
SignalSource readSignal(const app::TomlTable& table, Quantity quantity, ColumnNaming naming);
/// The same, or a `constant` in place of columns.
SignalSource readSignalOrConstant(const app::TomlTable& table, Quantity quantity, ColumnNaming naming);

}  // namespace patella::diagnose
