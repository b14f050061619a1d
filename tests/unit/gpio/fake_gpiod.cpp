#include "tests/unit/gpio/fake_gpiod.hpp"

#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

namespace patella::test {

FakeChip& chip() {
  static FakeChip instance;
  return instance;
}

void resetChip() {
  chip() = FakeChip{};
}

void FakeChip::drive(unsigned line, bool physical) {
  FakeLine& one = lines.at(line);
  if (one.physical != physical && one.both_edges) {
    const char edge = physical ? 'r' : 'f';
    [[maybe_unused]] const ssize_t written = write(one.events[1], &edge, 1);
  }
  one.physical = physical;
}

bool claim(unsigned line, bool output) {
  FakeLine& one = chip().lines.at(line);
  if (one.requested) {
    errno = EBUSY;
    return false;
  }
  one.requested = true;
  one.output = output;
  return output || pipe2(one.events.data(), O_CLOEXEC) == 0;
}

void release(unsigned line) {
  FakeLine& one = chip().lines.at(line);
  for (int& end : one.events) {
    if (end >= 0) {
      close(end);
    }
    end = -1;
  }
  one.requested = false;
  one.both_edges = false;
}

int readLevel(unsigned line) {
  const FakeLine& one = chip().lines.at(line);
  if (one.broken || !one.requested) {
    errno = EIO;
    return -1;
  }
  return one.physical != one.active_low ? 1 : 0;
}

int writeLevel(unsigned line, bool level) {
  FakeLine& one = chip().lines.at(line);
  if (one.broken || !one.requested || !one.output) {
    errno = EIO;
    return -1;
  }
  one.physical = level;
  chip().writes.append(1, static_cast<char>('0' + line)).append(level ? "=1 " : "=0 ");
  return 0;
}

int readEdges(int fd, unsigned most) {
  for (const FakeLine& one : chip().lines) {
    if (one.events[0] == fd && one.broken) {
      errno = ENODEV;
      return -1;
    }
  }
  if ((fcntl(fd, F_GETFL) & O_NONBLOCK) == 0) {
    errno = EDEADLK;  // the loop would hang here
    return -1;
  }
  std::array<char, 64> edges{};
  return static_cast<int>(read(fd, edges.data(), most < edges.size() ? most : edges.size()));
}

}  // namespace patella::test
