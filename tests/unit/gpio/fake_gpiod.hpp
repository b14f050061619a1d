// A GPIO chip in memory with libgpiod's functions in front of it. Levels are physical.
#pragma once

#include <array>
#include <cstdint>
#include <string>

namespace patella::test {

inline constexpr unsigned kLines = 8;

struct FakeLine {
  bool requested = false;
  bool output = false;
  bool active_low = false;
  bool both_edges = false;
  bool pull_up = false;
  bool pull_down = false;
  bool physical = false;
  bool broken = false;                ///< the device refuses everything
  std::array<int, 2> events{-1, -1};  ///< pipe: one byte an edge, as the kernel's queue
};

struct FakeChip {
  std::string path = "/dev/gpiochip0";
  std::array<FakeLine, kLines> lines{};
  int open_chips = 0;
  std::string writes;  ///< every output change in order, as "line=level "

  /// Drives an input; the kernel sees an edge when the level changes.
  void drive(unsigned line, bool physical);
};

FakeChip& chip();
/// A fresh chip.
void resetChip();

// The functions of both versions.
bool claim(unsigned line, bool output);
void release(unsigned line);
int readLevel(unsigned line);
int writeLevel(unsigned line, bool level);
/// Takes up to `most` edges off the queue; -1 with EAGAIN when there is none.
int readEdges(int fd, unsigned most);

}  // namespace patella::test
