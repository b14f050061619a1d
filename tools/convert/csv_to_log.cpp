#include "tools/convert/csv_to_log.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "drivers/can/candump_log.hpp"
#include "drivers/can/message_codec.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/files/wording.hpp"
#include "tools/convert/progress.hpp"
#include "tools/convert/protection.hpp"

namespace patella::convert {
namespace {

using app::CsvTable;
using app::FileError;
using app::formatNumber;

struct SignalStream {
  SignalSource source;
  const can::Signal* signal = nullptr;
  std::size_t slot = 0;
  std::vector<double> values;  // one for each instant; a single one for a constant
};

struct MessageStream {
  can::MessageEncoder encoder;
  std::vector<SignalStream> signals;
};

TimeBase readTime(const CsvTable& table, const ConversionMap& map, const std::string& file) {
  const auto column = table.column(map.time_column);
  std::vector<double> stamps(column.begin(), column.end());
  for (double& stamp : stamps) {
    stamp *= map.time_scale_s;
  }
  for (std::size_t row = 1; row < stamps.size(); ++row) {
    if (stamps[row] < stamps[row - 1]) {
      throw FileError(file + ":" + std::to_string(CsvTable::lineOf(row)) + ": column '" + map.time_column +
                      "': value " + formatNumber(column[row]) + ", expected at least " +
                      formatNumber(column[row - 1]) + " of the line before");
    }
  }
  return cleanTime(stamps);
}

std::vector<double> valuesOf(const SignalSource& source, const CsvTable& table, const TimeBase& base,
                             std::span<const double> grid) {
  if (source.columns.empty()) {
    return {source.offset};
  }
  std::vector<double> sum(table.rows(), source.offset);
  for (std::size_t i = 0; i < source.columns.size(); ++i) {
    const auto column = table.column(source.columns[i]);
    for (std::size_t row = 0; row < sum.size(); ++row) {
      sum[row] += source.scales[i] * column[row];
    }
  }
  return resample(base, sum, grid, source.interpolation);
}

class Converter {
 public:
  Converter(const std::filesystem::path& recording, const ConversionMap& map, const can::Database& database)
      : file_(recording.string()),
        map_(map),
        table_(CsvTable::load(recording,
                              {.delimiter = map.delimiter, .minimum_rows = 2, .columns = map.columns()})),
        base_(readTime(table_, map, file_)),
        grid_(map.rate_Hz ? uniformGrid(base_, *map.rate_Hz) : base_.time_s) {
    for (const MessageSource& source : map.messages) {
      const can::Message& message = database.message(source.message);
      MessageStream stream{can::MessageEncoder(message, usualProtection(message)), {}};
      for (const SignalSource& signal : source.signals) {
        stream.signals.push_back({.source = signal,
                                  .signal = message.find(signal.signal),
                                  .slot = stream.encoder.slot(signal.signal),
                                  .values = valuesOf(signal, table_, base_, grid_)});
      }
      streams_.push_back(std::move(stream));
    }
    report_ = {.rows = table_.rows(),
               .repeated_stamps = base_.repeated,
               .longest_gap_s = base_.longest_gap_s,
               .longest_gap_line = CsvTable::lineOf(base_.longest_gap_row),
               .instants = grid_.size()};
  }

  LogReport write(const std::filesystem::path& log) {
    app::AtomicFile out(log);
    std::array<char, can::kMaxLogLine> line{};
    Progress progress;
    for (std::size_t k = 0; k < grid_.size(); ++k) {
      progress.at(static_cast<double>(k) / static_cast<double>(grid_.size()));
      const auto wall_ns = std::llround((map_.start_wall_s + grid_[k]) * 1e6) * 1000;
      if (wall_ns < 0) {
        throw FileError(file_ + ":" + std::to_string(lineAt(k)) + ": column '" + map_.time_column +
                        "': time " + formatNumber(grid_[k]) +
                        " s lies before the start of wall time, expected a greater "
                        "log.start_wall_s");
      }
      for (MessageStream& stream : streams_) {
        can::Frame frame = stream.encoder.blank();
        frame.wall_ns = wall_ns;
        for (const SignalStream& signal : stream.signals) {
          encode(stream.encoder, signal, frame, k);
        }
        stream.encoder.seal(frame);
        out.write({line.data(), can::formatLogLine(line, frame, map_.channel)});
        ++report_.frames;
      }
    }
    out.commit();
    return report_;
  }

 private:
  void encode(const can::MessageEncoder& encoder, const SignalStream& signal, can::Frame& frame,
              std::size_t k) {
    const double value = signal.values.size() == 1 ? signal.values.front() : signal.values[k];
    const can::CompiledSignal& compiled = encoder.layout().signal(signal.slot);
    const bool fits = compiled.inRange(value) && encoder.set(frame, signal.slot, value);
    if (fits) {
      return;
    }
    if (!signal.source.clip) {
      reject(encoder.layout().name(), signal, value, k);
    }
    const can::Signal& range = *signal.signal;
    const bool declared = range.minimum < range.maximum;
    encoder.set(frame, signal.slot, declared ? std::clamp(value, range.minimum, range.maximum) : value);
    ++report_.clipped;
  }

  [[noreturn]] void reject(const std::string& message, const SignalStream& signal, double value,
                           std::size_t k) const {
    const can::Signal& range = *signal.signal;
    const std::string what =
        signal.source.columns.empty() ? "constant" : "column " + app::quotedList(signal.source.columns);
    throw FileError(file_ + ":" + std::to_string(lineAt(k)) + ": " + what + " gives " + message + "." +
                    range.name + " = " + formatNumber(value) + " " + range.unit + ", expected a number in [" +
                    formatNumber(range.minimum) + ", " + formatNumber(range.maximum) +
                    "]; 'clip = true' saturates");
  }

  /// Line of the last row at or before an instant.
  std::size_t lineAt(std::size_t k) const {
    const auto after = std::upper_bound(base_.time_s.begin(), base_.time_s.end(), grid_[k]);
    const auto index = static_cast<std::size_t>(after - base_.time_s.begin());
    return CsvTable::lineOf(base_.row[index == 0 ? 0 : index - 1]);
  }

  std::string file_;
  const ConversionMap& map_;
  CsvTable table_;
  TimeBase base_;
  std::vector<double> grid_;
  std::vector<MessageStream> streams_;
  LogReport report_;
};

}  // namespace

LogReport convertToLog(const std::filesystem::path& recording, const ConversionMap& map,
                       const can::Database& database, const std::filesystem::path& log) {
  return Converter(recording, map, database).write(log);
}

}  // namespace patella::convert
