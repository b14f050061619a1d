#include "firmware_app/realtime/service_notifier.hpp"

#include <array>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>

#include <doctest/doctest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace {

using patella::app::ServiceNotifier;
using std::chrono::milliseconds;

// Stands in for the service manager: a socket of the same kind, named in the environment.
class Manager {
 public:
  explicit Manager(const char* watchdog_us) {
    path_ = std::filesystem::temp_directory_path() / ("patella-notify-" + std::to_string(getpid()));
    socket_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.native().copy(address.sun_path, sizeof address.sun_path - 1);
    std::filesystem::remove(path_);
    REQUIRE(bind(socket_, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0);
    setenv("NOTIFY_SOCKET", path_.c_str(), 1);
    if (watchdog_us != nullptr) {
      setenv("WATCHDOG_USEC", watchdog_us, 1);
    }
  }
  ~Manager() {
    close(socket_);
    std::filesystem::remove(path_);
    unsetenv("NOTIFY_SOCKET");
    unsetenv("WATCHDOG_USEC");
  }
  Manager(const Manager&) = delete;
  Manager& operator=(const Manager&) = delete;

  /// What has come, joined by blanks.
  std::string heard() const {
    std::string all;
    std::array<char, 256> text{};
    for (ssize_t got = 0; (got = recv(socket_, text.data(), text.size(), 0)) > 0;) {
      all += (all.empty() ? "" : " ") + std::string(text.data(), static_cast<std::size_t>(got));
    }
    return all;
  }

 private:
  std::filesystem::path path_;
  int socket_ = -1;
};

constexpr ServiceNotifier::Instant kStart{};

TEST_CASE("the service is ready with the loop's first tick, not before") {
  const Manager manager(nullptr);
  ServiceNotifier notifier;
  notifier.progress(0, kStart);
  CHECK(manager.heard().empty());
  notifier.progress(1, kStart + milliseconds(10));
  CHECK(manager.heard() == "READY=1");
  notifier.progress(5000, kStart + milliseconds(5000));
  CHECK(manager.heard().empty());
  notifier.stopping();
  CHECK(manager.heard() == "STOPPING=1");
}

TEST_CASE("the watchdog is fed at half its period while ticks go on, and starves when they do not") {
  const Manager manager("200000");
  ServiceNotifier notifier;
  notifier.progress(1, kStart + milliseconds(10));
  CHECK(manager.heard() == "READY=1 WATCHDOG=1");
  notifier.progress(50, kStart + milliseconds(60));
  CHECK(manager.heard().empty());
  notifier.progress(100, kStart + milliseconds(110));
  CHECK(manager.heard() == "WATCHDOG=1");
  notifier.progress(100, kStart + milliseconds(500));
  CHECK(manager.heard().empty());
  notifier.progress(101, kStart + milliseconds(600));
  CHECK(manager.heard() == "WATCHDOG=1");
}

TEST_CASE("without a manager, or with one that is gone, nothing happens") {
  {
    ServiceNotifier notifier;
    notifier.progress(1, kStart);
  }
  setenv("NOTIFY_SOCKET", "/nonexistent/notify", 1);
  ServiceNotifier notifier;
  notifier.progress(1, kStart);
  notifier.stopping();
  unsetenv("NOTIFY_SOCKET");
}

TEST_CASE("a name too long for a socket is refused") {
  setenv("NOTIFY_SOCKET", ("/" + std::string(200, 'x')).c_str(), 1);
  CHECK_THROWS_WITH(ServiceNotifier(), doctest::Contains("201 characters long"));
  unsetenv("NOTIFY_SOCKET");
}

}  // namespace
