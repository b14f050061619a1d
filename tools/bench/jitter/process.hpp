// Other programs, run and waited for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace patella::bench {

/// A program that runs beside this one, in a process group of its own, until the object goes.
class BackgroundProgram {
 public:
  /// Throws std::runtime_error naming the program when it cannot be started.
  BackgroundProgram(const std::vector<std::string>& words, const std::filesystem::path& output);
  ~BackgroundProgram();
  BackgroundProgram(const BackgroundProgram&) = delete;
  BackgroundProgram& operator=(const BackgroundProgram&) = delete;

 private:
  pid_t pid_;
};

/// Runs a program to its end, output and errors into a file, and returns its exit status. Throws
/// std::runtime_error naming the program when it cannot be started or ends with a status above `tolerated`.
int runProgram(const std::vector<std::string>& words, const std::filesystem::path& output, int tolerated = 0);

}  // namespace patella::bench
