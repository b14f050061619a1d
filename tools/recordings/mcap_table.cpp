#include "tools/recordings/mcap_table.hpp"

#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "drivers/joined.hpp"
#include "firmware_app/files/wording.hpp"
#include "firmware_app/formats/mcap_reader.hpp"
#include "firmware_app/formats/tick_message.hpp"

namespace patella::diagnose {
namespace {

using app::FileError;

/// The messages of /patella/tick as lines of text, which read back as the same numbers.
class TickLines {
 public:
  explicit TickLines(const std::filesystem::path& file) : name_(file.string()), reader_(file) {
    while (!decoder_ && reader_.next(record_)) {
      learn();
    }
    if (!decoder_) {
      throw FileError(name_ + ": holds " +
                      (topics_.empty() ? std::string("no channel") : app::quotedList(topics_)) +
                      ", expected the ticks of a run (" + std::string(formats::kTickTopic) + ")" +
                      (reader_.cut() ? "; the file is cut off before them" : ""));
    }
  }

  std::string header() const { return joined(decoder_->columns(), ","); }

  bool next(std::string& line) {
    while (reader_.next(record_)) {
      const auto* message = std::get_if<formats::McapMessage>(&record_);
      if (message != nullptr && message->channel == channel_) {
        decode(message->data, line);
        return true;
      }
    }
    return false;
  }

  /// Valid when next() has returned false.
  bool cutOff() const noexcept { return reader_.cut(); }

 private:
  void learn() {
    if (const auto* schema = std::get_if<formats::McapSchemaRecord>(&record_)) {
      definitions_[schema->id] = schema->schema.text;
    }
    const auto* record = std::get_if<formats::McapChannelRecord>(&record_);
    if (record == nullptr) {
      return;
    }
    const formats::McapChannel& channel = record->channel;
    topics_.push_back(channel.topic);
    const auto columns = channel.metadata.find(formats::kColumnsKey);
    if (channel.topic != formats::kTickTopic || columns == channel.metadata.end()) {
      return;
    }
    try {
      decoder_.emplace(definitions_[channel.schema], columns->second);
    } catch (const std::invalid_argument& error) {
      throw FileError(name_ + ": " + channel.topic + ": " + error.what());
    }
    channel_ = record->id;
  }

  void decode(std::string_view message, std::string& line) {
    try {
      decoder_->decode(message, row_);
    } catch (const std::invalid_argument& error) {
      throw FileError(name_ + ": " + std::string(formats::kTickTopic) + ": " + error.what());
    }
    line.clear();
    for (std::size_t i = 0; i < row_.size(); ++i) {
      line += i == 0 ? "" : ",";
      if (!std::isnan(row_[i])) {
        app::appendFormatted(line, row_[i]);
      }
    }
  }

  std::string name_;
  formats::McapReader reader_;
  formats::McapRecord record_;
  std::map<std::uint16_t, std::string> definitions_;
  std::vector<std::string> topics_;
  std::optional<formats::TickDecoder> decoder_;
  std::uint16_t channel_ = 0;
  std::vector<double> row_;
};

}  // namespace

std::string mcapColumns(const std::filesystem::path& file) {
  return TickLines(file).header();
}

McapTable loadMcapTable(const std::filesystem::path& file, const app::CsvOptions& options) {
  TickLines lines(file);
  std::string text = lines.header();
  bool first = true;
  app::CsvOptions any_number = options;
  any_number.minimum_rows = 0;
  McapTable table;
  table.ticks = app::CsvTable::read(
      [&](std::string_view& line) {
        const bool more = std::exchange(first, false) || lines.next(text);
        line = text;
        return more;
      },
      std::filesystem::file_size(file), file.string(), any_number);
  table.cut_off = lines.cutOff();
  if (table.ticks.rows() < options.minimum_rows) {
    throw FileError(file.string() + ": " + std::to_string(table.ticks.rows()) + " ticks, expected at least " +
                    std::to_string(options.minimum_rows) +
                    (table.cut_off ? "; the file is cut off before them" : ""));
  }
  return table;
}

}  // namespace patella::diagnose
