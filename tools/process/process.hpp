// Other programs, started and waited for.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <sys/types.h>

namespace patella::process {

/// Where a program's output goes, in place of what the files held; one file may take both. Without a name it
/// goes where this program's goes.
struct Streams {
  std::filesystem::path output;
  std::filesystem::path errors = output;
};

struct Ending {
  int exit_status = -1;  ///< −1 when a signal ended it
  int signal = 0;
  double peak_MB = 0.0;  ///< of memory
};

/// Starts a program, which is looked for in PATH unless its name has a slash. `prepare` is called in the new
/// process, right before the program takes its place. One that cannot be started, or whose output cannot be
/// written to its file, ends with status 127 and a line among its errors. It is ended where this program is
/// interrupted. Throws std::system_error where there is no room for another process.
pid_t start(const std::vector<std::string>& words, const Streams& streams,
            const std::function<void()>& prepare = {});

Ending wait(pid_t pid);

/// Runs a program to its end, output and errors into one file, and returns its exit status. Throws
/// std::runtime_error naming the program when it ends with a status above `tolerated`, or by a signal.
int run(const std::vector<std::string>& words, const std::filesystem::path& output, int tolerated = 0);

/// A program that runs beside this one, in a process group of its own, until the object goes.
class Background {
 public:
  Background(const std::vector<std::string>& words, const std::filesystem::path& output);
  ~Background();
  Background(const Background&) = delete;
  Background& operator=(const Background&) = delete;

 private:
  pid_t pid_;
};

}  // namespace patella::process
