// What a maker says of a node's object dictionary: electronic data sheets (EDS) and device configuration
// files (DCF) after CiA 306.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "drivers/canopen/canopen_map.hpp"

namespace patella::canopen {

/// what() reads `file: [section] key: problem`, or `file:line: problem` where a line is no part of the
/// format.
class DataSheetError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An entry of the dictionary.
struct DataSheetEntry {
  std::string section;  ///< as the file writes it
  int data_type = 0;    ///< of CiA 301; 0: not stated, as of a record
  bool writable = false;
  bool mappable = false;                  ///< into a PDO
  std::optional<std::int64_t> parameter;  ///< of a DCF: what the entry is to hold
};

struct DataSheet {
  std::string source;         ///< file, for messages
  std::uint32_t vendor = 0;   ///< 0: not stated
  std::uint32_t product = 0;  ///< likewise
  std::map<std::pair<std::uint16_t, std::uint8_t>, DataSheetEntry> entries;
};

/// `node` stands for $NODEID. Names of sections and keys are taken in any case. Throws DataSheetError.
DataSheet parseDataSheet(std::string_view text, const std::string& name, int node);
/// Throws DataSheetError, also where the file cannot be read or is too long.
DataSheet loadDataSheet(const std::filesystem::path& path, int node);

/// Throws DataSheetError unless the sheet has every object that cyclic synchronous torque takes, each of its
/// type, and those of the PDOs mappable.
void requireTorqueDrive(const DataSheet& sheet);

/// Values of a DCF for what the set-up does not write by itself: objects from 2000h on without the commands,
/// in the order of their indices. Throws DataSheetError for one that is no integer of at most 4 bytes.
std::vector<ObjectValue> parametersOf(const DataSheet& sheet);

}  // namespace patella::canopen
