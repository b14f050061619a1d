// A row of ticks.csv as a message of type patella_msgs/msg/Tick, whose definition follows from the columns.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_app/formats/cdr.hpp"

namespace patella::formats {

inline constexpr std::string_view kTickType = "patella_msgs/msg/Tick";
inline constexpr std::string_view kTickTopic = "/patella/tick";
/// Key of the channel's metadata that holds the names of the columns, with commas between.
inline constexpr const char* kColumnsKey = "columns";

enum class FieldType { kFloat64, kUint8, kUint32 };

struct TickField {
  std::string name;  ///< lower case, without the number of the joint: tau_nm
  FieldType type = FieldType::kFloat64;
  std::size_t count = 1;  ///< columns that follow each other; an array where there is more than one
  bool is_array = false;
};

/// Columns q1_rad, q2_rad become float64[2] q_rad; the others keep their names. Lower case throughout, as ROS
/// 2 wants.
std::vector<TickField> tickFields(const std::vector<std::string>& columns);

/// The definition in ROS 2's language, with the numbers of states, faults and limits as constants.
std::string tickDefinition(const std::vector<TickField>& fields);

/// `row`: a number for each column, NaN for an empty cell. Throws std::invalid_argument for a whole number
/// that does not fit its type.
void encodeTick(CdrWriter& out, const std::vector<TickField>& fields, std::span<const double> row);

/// Takes Tick messages apart by the definition that came with them.
class TickDecoder {
 public:
  /// Throws std::invalid_argument for a definition with other types than tickDefinition() writes, or one that
  /// does not fit the columns.
  TickDecoder(std::string_view definition, std::string_view columns);

  const std::vector<std::string>& columns() const noexcept { return columns_; }
  /// A number for each column. Throws std::invalid_argument for a message that is too short.
  void decode(std::string_view message, std::vector<double>& row) const;

 private:
  std::vector<std::string> columns_;
  std::vector<TickField> fields_;
};

}  // namespace patella::formats
