#include "tools/recordings/raw_recording.hpp"

#include <fmt/format.h>

namespace patella::diagnose {

std::string placeOf(const RawRecording& recording, std::size_t row) {
  return recording.line.empty() ? fmt::format("{}: sample {}", recording.name, row + 1)
                                : fmt::format("{}:{}", recording.name, recording.line[row]);
}

void keepRows(RawRecording& recording, std::span<const std::size_t> rows) {
  const auto keep = [&](auto& values) {
    for (std::size_t i = 0; i < rows.size(); ++i) {
      values[i] = values[rows[i]];
    }
    values.resize(rows.size());
  };
  if (!recording.stamp_s.empty()) {
    keep(recording.stamp_s);
  }
  if (!recording.line.empty()) {
    keep(recording.line);
  }
  RawRecording::forEachSignal(recording,
                              [&](const std::string&, std::vector<double>& values) { keep(values); });
}

}  // namespace patella::diagnose
