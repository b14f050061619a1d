#include "tools/convert/log_to_csv.hpp"

#include <algorithm>
#include <limits>
#include <map>
#include <optional>
#include <vector>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/message_codec.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/files/wording.hpp"
#include "tools/convert/progress.hpp"
#include "tools/convert/protection.hpp"

namespace patella::convert {
namespace {

using Key = std::pair<std::uint32_t, bool>;  // identifier, extended

Key keyOf(const can::Frame& frame) {
  return {frame.id, frame.extended};
}

bool isData(const can::Frame& frame) {
  return !frame.error && !frame.remote;
}

/// "rad/s^2" becomes "rad_s2", "N.m" becomes "Nm", as column names of the project have it.
std::string columnName(const can::Message& message, const can::Signal& signal) {
  std::string name = message.name + "_" + signal.name;
  std::string unit;
  for (const char c : signal.unit) {
    if (c == '/' || c == ' ') {
      unit += '_';
    } else if (c != '.' && c != '^' && c != '*' && c != ',' && c != '"') {
      unit += c;
    }
  }
  return unit.empty() ? name : name + "_" + unit;
}

struct MessageColumns {
  can::MessageDecoder decoder;
  std::vector<std::pair<std::size_t, std::size_t>> slots;  // of the decoder -> column of the row
};

std::map<Key, std::size_t> countFrames(const std::filesystem::path& log) {
  std::map<Key, std::size_t> counts;
  can::CandumpReader reader(log);
  can::LogEntry entry;
  while (reader.next(entry)) {
    if (isData(entry.frame)) {
      ++counts[keyOf(entry.frame)];
    }
  }
  return counts;
}

Key chooseRowMessage(const std::map<Key, std::size_t>& counts, const can::Database& database,
                     const std::string& wanted, const std::filesystem::path& log) {
  if (!wanted.empty()) {
    const can::Message& message = database.message(wanted);
    const Key key{message.id, message.extended};
    if (!counts.contains(key)) {
      throw app::FileError(log.string() + ": no frame of message '" + wanted + "', expected at least one");
    }
    return key;
  }
  std::optional<Key> best;
  for (const auto& [key, count] : counts) {
    if (database.find(key.first, key.second) != nullptr && (!best || count > counts.at(*best))) {
      best = key;
    }
  }
  if (!best) {
    throw app::FileError(log.string() + ": no frame of a message that " + database.source + " describes");
  }
  return *best;
}

}  // namespace

CsvReport convertToCsv(const std::filesystem::path& log, const can::Database& database,
                       const std::string& row_message, const std::filesystem::path& csv) {
  const std::map<Key, std::size_t> counts = countFrames(log);
  const Key row_key = chooseRowMessage(counts, database, row_message, log);

  std::vector<std::string> names{"t_s"};
  std::map<Key, MessageColumns> messages;
  std::size_t total = 0;
  for (const auto& [key, count] : counts) {
    total += count;
    const can::Message* message = database.find(key.first, key.second);
    if (message == nullptr) {
      continue;
    }
    const can::Protection protection = usualProtection(*message);
    MessageColumns columns{can::MessageDecoder(*message, protection), {}};
    for (const can::Signal& signal : message->signals) {
      if (signal.name != protection.counter_signal && signal.name != protection.crc_signal) {
        columns.slots.emplace_back(columns.decoder.slot(signal.name), names.size());
        names.push_back(columnName(*message, signal));
      }
    }
    messages.emplace(key, std::move(columns));
  }

  CsvReport report{.row_message = database.find(row_key.first, row_key.second)->name};
  app::CsvWriter writer(csv, names);
  std::vector<double> row(names.size(), std::numeric_limits<double>::quiet_NaN());
  can::CandumpReader reader(log);
  can::LogEntry entry;
  std::optional<std::int64_t> start_ns;
  Progress progress;
  while (reader.next(entry)) {
    const can::Frame& frame = entry.frame;
    if (!isData(frame)) {
      continue;
    }
    start_ns = start_ns.value_or(frame.wall_ns);
    ++report.frames;
    progress.at(static_cast<double>(report.frames) / static_cast<double>(total));
    const auto found = messages.find(keyOf(frame));
    if (found == messages.end()) {
      ++report.unknown;
      continue;
    }
    MessageColumns& columns = found->second;
    const can::FrameStatus status = columns.decoder.check(frame).status;
    if (status == can::FrameStatus::kTooShort || status == can::FrameStatus::kCorrupt) {
      ++report.unusable;
      continue;
    }
    for (const auto& [slot, column] : columns.slots) {
      row[column] = columns.decoder.value(frame, slot);
    }
    if (found->first == row_key) {
      row[0] = static_cast<double>(frame.wall_ns - *start_ns) * 1e-9;
      writer.row(row);
      ++report.rows;
    }
  }
  report.cut_line = reader.cutLine();
  writer.commit();
  return report;
}

}  // namespace patella::convert
