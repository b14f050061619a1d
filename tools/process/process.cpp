#include "tools/process/process.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "drivers/files/interruption.hpp"

namespace patella::process {
namespace {

constexpr int kCannotStart = 127;  // as shells have it

// Between fork and exec, where next to nothing may be called.
void say(const char* text) {
  [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, text, std::strlen(text));
}

[[noreturn]] void giveUp(const char* what, const char* on) {
  const char* why = strerrordesc_np(errno);
  say(what);
  say(on);
  say(": ");
  say(why != nullptr ? why : "unknown error");
  say("\n");
  _exit(kCannotStart);
}

// What a program says must not be taken for what its parent says.
void redirect(int descriptor, const std::filesystem::path& path) {
  if (path.empty()) {
    return;
  }
  const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC, 0644);
  if (file < 0 || dup2(file, descriptor) < 0) {
    giveUp("cannot write ", path.c_str());
  }
}

}  // namespace

pid_t start(const std::vector<std::string>& words, const Streams& streams,
            const std::function<void()>& prepare) {
  std::vector<char*> arguments;
  for (const std::string& word : words) {
    arguments.push_back(const_cast<char*>(word.c_str()));
  }
  arguments.push_back(nullptr);
  const pid_t pid = files::startHelper(fork);
  if (pid < 0) {
    throw std::system_error(errno, std::generic_category(), "cannot start " + words[0]);
  }
  if (pid > 0) {
    return pid;
  }
  redirect(STDOUT_FILENO, streams.output);
  redirect(STDERR_FILENO, streams.errors);
  if (prepare) {
    prepare();
  }
  execvp(arguments[0], arguments.data());
  giveUp("cannot start ", arguments[0]);
}

Ending wait(pid_t pid) {
  int status = 0;
  struct rusage usage {};
  files::collectHelper(pid, [&] {
    while (wait4(pid, &status, 0, &usage) < 0 && errno == EINTR) {
    }
  });
  return {.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
          .peak_MB = 1e-3 * static_cast<double>(usage.ru_maxrss)};
}

int run(const std::vector<std::string>& words, const std::filesystem::path& output, int tolerated) {
  const Ending ending = wait(start(words, {.output = output}));
  if (ending.signal != 0 || ending.exit_status > tolerated) {
    throw std::runtime_error(words[0] + " ended with " +
                             (ending.signal != 0 ? "signal " + std::to_string(ending.signal)
                                                 : "status " + std::to_string(ending.exit_status)) +
                             ", see " + output.string());
  }
  return ending.exit_status;
}

Background::Background(const std::vector<std::string>& words, const std::filesystem::path& output)
    : pid_(start(words, {.output = output}, [] { setpgid(0, 0); })) {
  setpgid(pid_, pid_);  // whichever of the two comes first: the group is there when it is to be ended
}

Background::~Background() {
  kill(-pid_, SIGTERM);
  wait(pid_);
}

}  // namespace patella::process
