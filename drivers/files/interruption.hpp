// What a program that is interrupted takes with it: files that nobody keeps, and the programs that it has
// started. Ended by a signal, it would not unwind.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <thread>

#include <sys/types.h>

namespace patella::files {

/// A path that goes, with everything in it, when the program is interrupted while the object lives.
class UnkeptPath {
 public:
  UnkeptPath() = default;
  ~UnkeptPath();
  UnkeptPath(const UnkeptPath&) = delete;
  UnkeptPath& operator=(const UnkeptPath&) = delete;

  /// `make` creates what is there and returns its name. An interruption waits until it is known. Once per
  /// object.
  void create(const std::function<std::filesystem::path()>& make);

 private:
  std::string path_;
};

/// `start` starts a program and returns its number, or one below 0; an interruption ends it first.
pid_t startHelper(const std::function<pid_t()>& start);

/// `collect` asks for the status of one that has ended, whose number then is another's.
void collectHelper(pid_t helper, const std::function<void()>& collect);

/// While it lives, SIGINT, SIGTERM and SIGHUP end the helpers and remove the unkept paths before they end the
/// program. Signals that are ignored stay ignored. One object at a time, made before other threads.
class CleanEnd {
 public:
  /// Throws std::system_error.
  CleanEnd();
  ~CleanEnd();
  CleanEnd(const CleanEnd&) = delete;
  CleanEnd& operator=(const CleanEnd&) = delete;

 private:
  std::thread thread_;
};

}  // namespace patella::files
