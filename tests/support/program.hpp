// A program run as a user runs it: by its arguments, with what it prints and how it ends.
#pragma once

#include <string>
#include <vector>

namespace patella::test {

struct Outcome {
  int exit_status = -1;  ///< −1 when a signal ended it
  int signal = 0;
  std::string output;    ///< standard output
  std::string errors;    ///< standard error
  double peak_MB = 0.0;  ///< of memory
};

/// Arguments are taken as they are, without a shell. A foreign architecture's executable runs in the emulator
/// that the build names.
Outcome runProgram(const std::string& executable, const std::vector<std::string>& arguments);

}  // namespace patella::test
