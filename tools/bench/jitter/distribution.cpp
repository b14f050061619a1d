#include "tools/bench/jitter/distribution.hpp"

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <string>

namespace patella::bench {
namespace {

/// Reads a number with leading blanks and zeros off the front; false when there is none.
bool takeNumber(std::string_view& text, std::uint64_t& value) {
  const std::size_t start = text.find_first_not_of(" \t");
  if (start == std::string_view::npos) {
    return false;
  }
  const auto read = std::from_chars(text.data() + start, text.data() + text.size(), value);
  text.remove_prefix(static_cast<std::size_t>(read.ptr - text.data()));
  return read.ec == std::errc{};
}

/// The first number behind the colon of a comment such as "# Max Latencies: 00042".
std::uint64_t commentNumber(std::string_view line) {
  std::uint64_t value = 0;
  line.remove_prefix(line.find(':') + 1);
  takeNumber(line, value);
  return value;
}

}  // namespace

void Distribution::add(double upper_us, std::uint64_t count) {
  if (count == 0) {
    return;
  }
  buckets_[upper_us] += count;
  count_ += count;
}

void Distribution::sawMaximum(double maximum_us) {
  maximum_us_ = std::max(maximum_us_, maximum_us);
}

void Distribution::merge(const Distribution& other) {
  for (const auto& [upper_us, count] : other.buckets_) {
    add(upper_us, count);
  }
  beyond_ += other.beyond_;
  sawMaximum(other.maximum_us_);
}

double Distribution::quantile_us(double quantile) const {
  const double wanted = quantile * static_cast<double>(count_);
  std::uint64_t seen = 0;
  for (const auto& [upper_us, count] : buckets_) {
    seen += count;
    if (static_cast<double>(seen) >= wanted) {
      return std::min(upper_us, maximum_us_);
    }
  }
  return maximum_us_;
}

std::vector<double> wakeUps(std::span<const double> t_s, std::span<const double> wakeup_us,
                            std::span<const double> execution_us) {
  std::vector<double> slept;
  for (std::size_t i = 0; i < t_s.size(); ++i) {
    if (i == 0 || wakeup_us[i - 1] + execution_us[i - 1] < 1e6 * (t_s[i] - t_s[i - 1])) {
      slept.push_back(wakeup_us[i]);
    }
  }
  return slept;
}

Distribution ofLatencies(std::span<const double> latencies_us) {
  Distribution result;
  for (const double latency_us : latencies_us) {
    result.add(latency_us, 1);
    result.sawMaximum(latency_us);
  }
  return result;
}

Distribution fromCyclictest(std::string_view text) {
  Distribution result;
  std::uint64_t overflows = 0;
  for (std::size_t number = 1; !text.empty(); ++number) {
    std::string_view line = text.substr(0, text.find('\n'));
    text.remove_prefix(std::min(text.size(), line.size() + 1));
    if (line.starts_with("# Max Latencies:")) {
      result.sawMaximum(1e-3 * static_cast<double>(commentNumber(line)));
    } else if (line.starts_with("# Histogram Overflows:")) {
      overflows = commentNumber(line);
    }
    if (line.empty() || line[0] < '0' || line[0] > '9') {
      continue;
    }
    const std::string_view whole = line;
    std::uint64_t latency_ns = 0;
    std::uint64_t count = 0;
    if (!takeNumber(line, latency_ns) || !takeNumber(line, count)) {
      throw std::runtime_error("cyclictest, line " + std::to_string(number) + ": '" + std::string(whole) +
                               "', expected a latency and a count");
    }
    result.add(1e-3 * static_cast<double>(latency_ns), count);
  }
  result.add(result.maximum_us(), overflows);
  result.beyond_ = overflows;
  if (result.count() == 0) {
    throw std::runtime_error("cyclictest printed no histogram");
  }
  return result;
}

}  // namespace patella::bench
