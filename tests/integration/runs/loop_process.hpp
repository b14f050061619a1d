// `patella run` as a process of its own, with the demonstration's configuration.
#pragma once

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <vector>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/support/paths.hpp"

namespace patella::test {

/// Its output goes to the file `said`. `prepare` is called in the new process, right before the program
/// takes its place.
inline pid_t start(
    std::vector<std::string> arguments, const std::filesystem::path& said,
    const std::function<void()>& prepare = [] {}) {
  const std::string config = std::string(PATELLA_SOURCE_DIR) + "/firmware_app/config/adult.toml";
  arguments.insert(arguments.begin(), {PATELLA_EXECUTABLE, "run", "--config", config});
  std::vector<char*> words;
  for (std::string& argument : arguments) {
    words.push_back(argument.data());
  }
  words.push_back(nullptr);
  const pid_t child = fork();
  if (child == 0) {
    const int file = open(said.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
    dup2(file, STDERR_FILENO);
    dup2(file, STDOUT_FILENO);
    prepare();
    execv(words[0], words.data());
    _exit(127);
  }
  return child;
}

/// Exit status, or the signal that ended it, negative.
inline int wait(pid_t child) {
  int status = 0;
  waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
}

inline std::string read(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace patella::test
