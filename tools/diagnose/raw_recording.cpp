#include "tools/diagnose/raw_recording.hpp"

namespace patella::diagnose {

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
