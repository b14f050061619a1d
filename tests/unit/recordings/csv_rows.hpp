// Small recordings of one joint as CSV.
#pragma once

#include <functional>
#include <string>

#include <fmt/format.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/recordings/recording_file.hpp"

namespace patella::test {

/// A header and `rows` lines that `line` makes of their number.
inline std::string csv(const std::string& header, int rows, const std::function<std::string(int)>& line) {
  std::string text = header + "\n";
  for (int i = 0; i < rows; ++i) {
    text += line(i) + "\n";
  }
  return text;
}

/// Result of loadRecording() for a file with this text, the model having one joint.
inline diagnose::Recording loaded(const std::string& text,
                                  diagnose::RecordingOptions options = {.joints = 1}) {
  const ScratchFolder folder;
  app::writeFile(folder / "run.csv", text);
  return loadRecording(folder / "run.csv", options);
}

inline constexpr const char* kOneJoint = "t_s,q1_rad,tau1_Nm";

/// A thousand rows a second of one joint, with position and torque by the number of the row.
inline diagnose::Recording loadedRows(int rows, const std::function<double(int)>& position_rad,
                                      const std::function<double(int)>& torque_Nm) {
  return loaded(csv(kOneJoint, rows, [&](int i) {
    return fmt::format("{:.3f},{:.9f},{:.6f}", 0.001 * i, position_rad(i), torque_Nm(i));
  }));
}

/// Message of the exception that loading ends with, the folder's name taken off.
inline std::string refusal(const std::string& text,
                           const diagnose::RecordingOptions& options = {.joints = 1}) {
  const std::string message = messageOf<app::FileError>([&] { loaded(text, options); });
  const auto at = message.find("run.csv");
  return at == std::string::npos ? message : message.substr(at);
}

}  // namespace patella::test
