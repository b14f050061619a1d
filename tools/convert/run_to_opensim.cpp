#include "tools/convert/run_to_opensim.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/wording.hpp"
#include "tools/convert/run_signals.hpp"

namespace patella::convert {
namespace {

OpenSimReport write(const RunSignals& signals, const std::vector<std::string>& names,
                    const std::filesystem::path& file) {
  app::AtomicFile out(file);
  std::string text = file.stem().string() + "\nversion=1\nnRows=" + std::to_string(signals.samples) +
                     "\nnColumns=" + std::to_string(names.size() + 1) + "\ninDegrees=no\nendheader\ntime";
  for (const std::string& name : names) {
    text += "\t" + name;
  }
  out.write(text + "\n");
  forEachSample(signals, [&](double time_s, std::span<const double> values) {
    text.clear();
    app::appendFormatted(text, signals.start_s + time_s);
    for (const double value : values) {
      text += '\t';
      app::appendFormatted(text, value);
    }
    out.write(text + "\n");
  });
  out.commit();
  return {.rows = signals.samples, .columns = names};
}

}  // namespace

OpenSimReport convertRunToSto(const std::filesystem::path& run, const std::filesystem::path& sto) {
  const RunSignals signals = findSignals(run, std::array<std::string, 3>{"emg", "activation", "tau"});
  std::vector<std::string> names;
  for (const RunSignal& signal : signals.signals) {
    names.push_back(signal.column);
  }
  return write(signals, names, sto);
}

OpenSimReport convertRunToMot(const std::filesystem::path& run, const std::vector<std::string>& coordinates,
                              const std::filesystem::path& mot) {
  const RunSignals signals = findSignals(run, std::array<std::string, 1>{"q"});
  std::vector<std::string> names = coordinates;
  for (std::size_t joint = 1; coordinates.empty() && joint <= signals.signals.size(); ++joint) {
    names.push_back("joint_" + std::to_string(joint));
  }
  if (names.size() != signals.signals.size()) {
    throw app::FileError(run.string() + ": " + std::to_string(names.size()) +
                         " names of coordinates, expected " + std::to_string(signals.signals.size()) +
                         " as the run has joints");
  }
  for (std::size_t joint = 1; joint < names.size(); ++joint) {
    const auto here = names.begin() + static_cast<std::ptrdiff_t>(joint);
    if (std::find(names.begin(), here, *here) != here) {
      throw std::invalid_argument("--coordinates: name '" + *here +
                                  "' appears twice, expected one for each joint");
    }
  }
  return write(signals, names, mot);
}

}  // namespace patella::convert
