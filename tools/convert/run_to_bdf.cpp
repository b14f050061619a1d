#include "tools/convert/run_to_bdf.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <ctime>
#include <span>
#include <string>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <edflib.h>

#include "drivers/can/candump_log.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tools/convert/run_events.hpp"
#include "tools/convert/run_signals.hpp"

namespace patella::convert {
namespace {

constexpr int kDigitalMaximum = 8'388'607;
constexpr double kAnnotationUnits_1_s = 1e4;

struct Annotation {
  double time_s;
  std::string text;
};

/// Label and unit of a column: electrodes as EDF+ names them, "EMG" and which.
struct Naming {
  std::string stem, label, unit;
};
const std::array kNamings = {Naming{"emg", "EMG ", "mV"}, Naming{"activation", "activation ", ""},
                             Naming{"q", "angle ", "rad"}, Naming{"tau", "torque ", "N.m"}};

const Naming& namingOf(const std::string& column) {
  const std::size_t digit = column.find_first_of("0123456789");
  return *std::find_if(kNamings.begin(), kNamings.end(),
                       [&](const Naming& naming) { return naming.stem == column.substr(0, digit); });
}

std::string numberOf(const std::string& column) {
  const std::size_t digit = column.find_first_of("0123456789");
  return column.substr(digit, column.find_first_not_of("0123456789", digit) - digit);
}

/// The next of 1, 2, 5, 10 … from 0.001 on: eight characters of the header hold it exactly.
double rangeOf(double largest) {
  for (double decade = 1e-3; decade < 1e6; decade *= 10.0) {
    for (const double step : {1.0, 2.0, 5.0}) {
      const double range = std::round(decade * step * 1e3) / 1e3;
      if (largest <= range) {
        return range;
      }
    }
  }
  return 0.0;
}

/// What changed at each event, a part each: a program shows an annotation in forty characters.
std::vector<Annotation> annotationsOf(const std::filesystem::path& run, double start_s) {
  std::vector<Annotation> annotations;
  for (RunEvents events(run / "events.log"); events.more(); events.advance()) {
    const std::string& line = events.line();
    for (std::size_t at = line.find(' '); at != std::string::npos;) {
      const std::size_t end = line.find(' ', at + 1);
      annotations.push_back({events.time_s() - start_s, line.substr(at + 1, end - at - 1)});
      at = end;
    }
  }
  return annotations;
}

/// Wall time of the run's first frame; that of the format's beginning where there is none.
std::int64_t startOf(const std::filesystem::path& run) {
  constexpr std::int64_t kEarliest_ns = 473'385'600'000'000'000;  // 1985-01-01
  const std::filesystem::path log = run / "frames.log";
  can::LogEntry entry;
  if (!std::filesystem::exists(log) || !can::CandumpReader(log).next(entry)) {
    return kEarliest_ns;
  }
  return std::max(entry.frame.wall_ns, kEarliest_ns);
}

/// The file, which takes its name when it is whole.
class BdfFile {
 public:
  BdfFile(const std::filesystem::path& target, int signals)
      : file_(target),
        handle_(edfopen_file_writeonly(file_.temporary().c_str(), EDFLIB_FILETYPE_BDFPLUS, signals)) {
    if (handle_ < 0) {
      throw app::FileError(file_.target().string() +
                           ": cannot be created: " + std::generic_category().message(errno));
    }
  }
  ~BdfFile() {
    if (handle_ >= 0) {
      edfclose_file(handle_);
    }
  }
  BdfFile(const BdfFile&) = delete;
  BdfFile& operator=(const BdfFile&) = delete;

  int handle() const noexcept { return handle_; }
  void require(int result, const char* what) const {
    if (result != 0) {
      throw app::FileError(file_.target().string() + ": " + what + " cannot be written");
    }
  }
  void commit() {
    require(edfclose_file(std::exchange(handle_, -1)), "its end");
    file_.commit();
  }

 private:
  app::AtomicFile file_;
  int handle_;
};

void describe(const BdfFile& file, int index, const RunSignal& signal, int rate_Hz, double range) {
  const Naming& naming = namingOf(signal.column);
  const int handle = file.handle();
  file.require(edf_set_samplefrequency(handle, index, rate_Hz), "a rate");
  file.require(edf_set_physical_maximum(handle, index, range), "a range");
  file.require(edf_set_physical_minimum(handle, index, -range), "a range");
  file.require(edf_set_digital_maximum(handle, index, kDigitalMaximum), "a range");
  file.require(edf_set_digital_minimum(handle, index, -kDigitalMaximum), "a range");
  file.require(edf_set_label(handle, index, (naming.label + numberOf(signal.column)).c_str()), "a label");
  file.require(edf_set_physical_dimension(handle, index, naming.unit.c_str()), "a unit");
}

void describeStart(const BdfFile& file, std::int64_t wall_ns) {
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::time_t seconds = wall_ns / kSecond_ns;
  std::tm utc{};
  gmtime_r(&seconds, &utc);
  file.require(edf_set_startdatetime(file.handle(), utc.tm_year + 1900, utc.tm_mon + 1, utc.tm_mday,
                                     utc.tm_hour, utc.tm_min, utc.tm_sec),
               "its date");
  file.require(
      edf_set_subsecond_starttime(file.handle(), static_cast<int>(wall_ns % kSecond_ns / 100'000 * 1000)),
      "its date");
  file.require(edf_set_equipment(file.handle(), "Patella " PATELLA_VERSION), "the equipment");
}

/// As many annotations as seconds find room in one channel of them.
void makeRoom(const BdfFile& file, const std::filesystem::path& bdf, std::size_t annotations,
              std::size_t records) {
  constexpr std::size_t kMostChannels = 64;
  const std::size_t channels = std::max<std::size_t>((annotations + records - 1) / records, 1);
  if (channels > kMostChannels) {
    throw app::FileError(bdf.string() + ": " + std::to_string(annotations) + " annotations in " +
                         std::to_string(records) + " s, expected at most " +
                         std::to_string(kMostChannels * records) + " as BDF+ can hold");
  }
  file.require(edf_set_number_of_annotation_signals(file.handle(), static_cast<int>(channels)),
               "annotations");
}

/// Signals of one kind by their number, "emg2" before "emg10".
void sortByKind(std::vector<RunSignal>& signals) {
  const auto rank = [](const RunSignal& signal) {
    return std::tuple(&namingOf(signal.column), signal.column.size(), signal.column);
  };
  std::sort(signals.begin(), signals.end(),
            [&](const RunSignal& a, const RunSignal& b) { return rank(a) < rank(b); });
}

/// Writes the head of each signal; returns their ranges, ±, in the units of the signals.
std::vector<double> describeSignals(const BdfFile& file, const RunSignals& run_signals) {
  std::vector<double> ranges;
  for (const RunSignal& signal : run_signals.signals) {
    ranges.push_back(rangeOf(signal.largest));
    if (ranges.back() == 0.0) {
      throw app::FileError(run_signals.ticks.string() + ": column '" + signal.column +
                           "': a value beyond 5000000, which BDF+ cannot hold");
    }
    describe(file, static_cast<int>(ranges.size()) - 1, signal, run_signals.rate_Hz, ranges.back());
  }
  return ranges;
}

/// A record of each signal for every second, the last one filled up. Returns the samples that were held.
std::size_t writeSamples(const BdfFile& file, const RunSignals& run_signals,
                         const std::vector<double>& ranges) {
  const auto rate = static_cast<std::size_t>(run_signals.rate_Hz);
  std::vector<std::vector<int>> record(ranges.size());
  const auto flush = [&] {
    for (std::vector<int>& samples : record) {
      samples.resize(rate, samples.back());
      file.require(edfwrite_digital_samples(file.handle(), samples.data()), "samples");
      samples.clear();
    }
  };
  const std::size_t held = forEachSample(run_signals, [&](double /*time_s*/, std::span<const double> values) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      record[i].push_back(static_cast<int>(std::lround(values[i] / ranges[i] * kDigitalMaximum)));
    }
    if (record.front().size() == rate) {
      flush();
    }
  });
  if (!record.front().empty()) {
    flush();
  }
  return held;
}

void writeAnnotations(const BdfFile& file, const std::vector<Annotation>& annotations) {
  for (const Annotation& annotation : annotations) {
    file.require(
        edfwrite_annotation_utf8(file.handle(), std::llround(annotation.time_s * kAnnotationUnits_1_s), -1,
                                 annotation.text.c_str()),
        "an annotation");
  }
}

}  // namespace

BdfReport convertRunToBdf(const std::filesystem::path& run, const std::filesystem::path& bdf) {
  std::vector<std::string> stems;
  for (const Naming& naming : kNamings) {
    stems.push_back(naming.stem);
  }
  RunSignals run_signals = findSignals(run, stems);
  sortByKind(run_signals.signals);
  const auto rate = static_cast<std::size_t>(run_signals.rate_Hz);
  const std::size_t records = (run_signals.samples + rate - 1) / rate;
  std::vector<Annotation> annotations = annotationsOf(run, run_signals.start_s);
  annotations.push_back({static_cast<double>(run_signals.samples) / run_signals.rate_Hz, "end of the run"});

  BdfFile file(bdf, static_cast<int>(run_signals.signals.size()));
  const std::vector<double> ranges = describeSignals(file, run_signals);
  describeStart(file, startOf(run) + std::llround(1e9 * run_signals.start_s));
  makeRoom(file, bdf, annotations.size(), records);
  const std::size_t held = writeSamples(file, run_signals, ranges);
  writeAnnotations(file, annotations);
  file.commit();
  return {.signals = run_signals.signals.size(),
          .samples = run_signals.samples,
          .rate_Hz = run_signals.rate_Hz,
          .held = held,
          .annotations = annotations.size()};
}

}  // namespace patella::convert
