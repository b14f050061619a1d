// The ticks of a run that was recorded in MCAP, as the table that they are in ticks.csv.
#pragma once

#include <filesystem>
#include <string>

#include "firmware_app/files/csv_table.hpp"

namespace patella::diagnose {

/// The columns, with commas between. Throws app::FileError, also for a file without the ticks of a run.
std::string mcapColumns(const std::filesystem::path& file);

struct McapTable {
  app::CsvTable ticks;
  bool cut_off = false;  ///< the file ends in the midst of its data, and more ticks may have followed
};

/// As CsvTable::load() reads ticks.csv; of a file that was cut off, what is whole.
McapTable loadMcapTable(const std::filesystem::path& file, const app::CsvOptions& options);

}  // namespace patella::diagnose
