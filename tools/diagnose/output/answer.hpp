// A diagnosis on the console.
#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <string>
#include <string_view>
#include <utility>

#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// At most eighteen lines: the verdict, the effects with their parameters and rivals, the errors of the
/// model as given and of the extended one against the noise floor, what to look at twice, the plan of a
/// better motion, where the files are.
void printAnswer(const Diagnosis& diagnosis, const std::filesystem::path& folder, std::ostream& out);

/// Says how far it is: on a terminal in one line that changes, elsewhere in one line for each stage and for
/// every ten seconds of it.
class ProgressLine {
 public:
  using Clock = std::function<std::chrono::steady_clock::time_point()>;

  ProgressLine(std::ostream& out, bool terminal, Clock now = std::chrono::steady_clock::now)
      : out_(out), terminal_(terminal), now_(std::move(now)) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void at(std::string_view stage, double fraction);
  /// Leaves the line empty for what comes next.
  void clear();

 private:
  std::ostream& out_;
  bool terminal_;
  Clock now_;
  std::chrono::steady_clock::time_point said_;
  std::string stage_;
  int percent_ = -1;
};

}  // namespace patella::diagnose
