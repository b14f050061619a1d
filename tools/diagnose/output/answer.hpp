// A diagnosis on the console.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <string>
#include <string_view>

#include "tools/diagnose/result/diagnosis.hpp"

namespace patella::diagnose {

/// At most seventeen lines: the verdict, the effects with their parameters and rivals, the errors of the
/// model as given and of the extended one against the noise floor, what to look at twice, the plan of a
/// better motion, where the files are.
void printAnswer(const Diagnosis& diagnosis, const std::filesystem::path& folder, std::ostream& out);

/// Says how far it is: on a terminal in one line that changes, elsewhere in one line for each stage.
class ProgressLine {
 public:
  ProgressLine(std::ostream& out, bool terminal) : out_(out), terminal_(terminal) {}
  ~ProgressLine() { clear(); }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void at(std::string_view stage, double fraction);
  /// Leaves the line empty for what comes next.
  void clear();

 private:
  std::ostream& out_;
  bool terminal_;
  std::string stage_;
  int percent_ = -1;
};

}  // namespace patella::diagnose
