#include "tools/bench/jitter/process.hpp"

#include <cerrno>
#include <csignal>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace patella::bench {
namespace {

pid_t start(const std::vector<std::string>& words, const std::filesystem::path& output) {
  std::vector<char*> arguments;
  for (const std::string& word : words) {
    arguments.push_back(const_cast<char*>(word.c_str()));
  }
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
  pid_t pid = -1;
  const int error = posix_spawnp(&pid, arguments[0], &files, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&files);
  if (error != 0) {
    throw std::runtime_error("cannot start " + words[0] + ": " + std::generic_category().message(error));
  }
  return pid;
}

int wait(pid_t pid) {
  int status = 0;
  while (waitpid(pid, &status, 0) < 0 && errno == EINTR) {
  }
  return status;
}

}  // namespace

BackgroundProgram::BackgroundProgram(const std::vector<std::string>& words,
                                     const std::filesystem::path& output)
    : pid_(start(words, output)) {}

BackgroundProgram::~BackgroundProgram() {
  kill(-pid_, SIGTERM);
  wait(pid_);
}

int runProgram(const std::vector<std::string>& words, const std::filesystem::path& output, int tolerated) {
  const int status = wait(start(words, output));
  if (!WIFEXITED(status) || WEXITSTATUS(status) > tolerated) {
    throw std::runtime_error(words[0] + " ended with " +
                             (WIFEXITED(status) ? "status " + std::to_string(WEXITSTATUS(status))
                                                : "signal " + std::to_string(WTERMSIG(status))) +
                             ", see " + output.string());
  }
  return WEXITSTATUS(status);
}

}  // namespace patella::bench
