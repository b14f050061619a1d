#include "drivers/files/interruption.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <mutex>
#include <set>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "drivers/signal_stack.hpp"

namespace patella::files {
namespace {

constexpr std::array kInterruptions{SIGINT, SIGTERM, SIGHUP};
/// A helper that has not ended after this long is ended by force.
constexpr std::chrono::milliseconds kPatience{3000};
constexpr std::chrono::milliseconds kBetweenLooks{5};

struct Unkept {
  std::mutex mutex;
  pid_t owner = getpid();
  std::set<std::string> paths;
  std::set<pid_t> helpers;
};

/// Never destroyed: objects that outlive main() use it, too.
Unkept& unkept() {
  static auto* const all = new Unkept;
  return *all;
}

/// After a fork, what was there is the parent's.
void leaveToParent(Unkept& all) {
  if (std::exchange(all.owner, getpid()) != getpid()) {
    all.paths.clear();
    all.helpers.clear();
  }
}

// For the handler, which may call next to nothing: a byte to the thread that does the work.
int wake_end = -1;
int thread_end = -1;
pid_t owner = 0;

void onInterruption(int signal) {
  if (getpid() != owner) {  // between fork and exec
    std::signal(signal, SIG_DFL);
    raise(signal);
    return;
  }
  const int error = errno;
  const auto byte = static_cast<unsigned char>(signal);
  [[maybe_unused]] const ssize_t written = write(wake_end, &byte, 1);
  errno = error;
}

bool hasEnded(pid_t helper) {
  siginfo_t info{};
  return waitid(P_PID, static_cast<id_t>(helper), &info, WEXITED | WNOHANG | WNOWAIT) != 0 ||
         info.si_pid == helper;
}

void endHelpers(const std::set<pid_t>& helpers) {
  for (const pid_t helper : helpers) {
    kill(helper, SIGTERM);
  }
  const auto latest = std::chrono::steady_clock::now() + kPatience;
  for (const pid_t helper : helpers) {
    while (!hasEnded(helper) && std::chrono::steady_clock::now() < latest) {
      std::this_thread::sleep_for(kBetweenLooks);
    }
    if (!hasEnded(helper)) {
      kill(helper, SIGKILL);
    }
  }
}

/// Waits for a signal's byte, or 0 from the object's end.
void watch() {
  unsigned char signal = 0;
  while (read(thread_end, &signal, 1) < 0 && errno == EINTR) {
  }
  if (signal == 0) {
    return;
  }
  // Held to the end: whoever makes another path waits for an end that is the program's.
  const std::scoped_lock lock(unkept().mutex);
  endHelpers(unkept().helpers);
  for (const std::string& path : unkept().paths) {
    std::error_code ignored;
    std::filesystem::remove_all(path, ignored);
  }
  std::signal(signal, SIG_DFL);
  sigset_t deadly;
  sigemptyset(&deadly);
  sigaddset(&deadly, signal);
  pthread_sigmask(SIG_UNBLOCK, &deadly, nullptr);
  raise(signal);
}

}  // namespace

void UnkeptPath::create(const std::function<std::filesystem::path()>& make) {
  const std::scoped_lock lock(unkept().mutex);
  path_ = std::filesystem::absolute(make()).string();
  unkept().paths.insert(path_);
}

UnkeptPath::~UnkeptPath() {
  if (!path_.empty()) {
    const std::scoped_lock lock(unkept().mutex);
    unkept().paths.erase(path_);
  }
}

pid_t startHelper(const std::function<pid_t()>& start) {
  const std::scoped_lock lock(unkept().mutex);
  const pid_t helper = start();
  if (helper > 0) {
    unkept().helpers.insert(helper);
  }
  return helper;
}

void collectHelper(pid_t helper, const std::function<void()>& collect) {
  siginfo_t info{};
  while (waitid(P_PID, static_cast<id_t>(helper), &info, WEXITED | WNOWAIT) != 0 && errno == EINTR) {
  }
  const std::scoped_lock lock(unkept().mutex);
  collect();
  unkept().helpers.erase(helper);
}

CleanEnd::CleanEnd() {
  std::array<int, 2> ends{};
  if (pipe2(ends.data(), O_CLOEXEC) != 0) {
    throw std::system_error(errno, std::generic_category(), "a pipe");
  }
  std::tie(thread_end, wake_end) = std::pair(ends[0], ends[1]);
  owner = getpid();
  {
    const std::scoped_lock lock(unkept().mutex);
    leaveToParent(unkept());
  }
  thread_ = startThread(watch);
  for (const int signal : kInterruptions) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_DFL) {
      action = {};
      action.sa_handler = onInterruption;
      action.sa_flags = SA_RESTART;
      sigaction(signal, &action, nullptr);
    }
  }
}

CleanEnd::~CleanEnd() {
  for (const int signal : kInterruptions) {
    struct sigaction action {};
    sigaction(signal, nullptr, &action);
    if (action.sa_handler == onInterruption) {
      std::signal(signal, SIG_DFL);
    }
  }
  const unsigned char end = 0;
  [[maybe_unused]] const ssize_t written = write(wake_end, &end, 1);
  thread_.join();
  close(wake_end);
  close(thread_end);
}

}  // namespace patella::files
