// libgpiod 1.6 in front of the chip in memory; see gpiod.h for what each function promises.
#include <array>
#include <cerrno>

#include <gpiod.h>

#include "tests/unit/gpio/fake_gpiod.hpp"

using patella::test::chip;

struct gpiod_line {
  unsigned offset = 0;
};
struct gpiod_chip {
  std::array<gpiod_line, patella::test::kLines> lines{};
  std::array<bool, patella::test::kLines> claimed{};
};

extern "C" {

gpiod_chip* gpiod_chip_open(const char* path) {
  if (chip().path != path) {
    errno = ENOENT;
    return nullptr;
  }
  ++chip().open_chips;
  return new gpiod_chip;
}

void gpiod_chip_close(gpiod_chip* opened) {
  for (const gpiod_line& line : opened->lines) {
    if (chip().lines.at(line.offset).requested && opened->claimed.at(line.offset)) {
      patella::test::release(line.offset);
    }
  }
  --chip().open_chips;
  delete opened;
}

gpiod_line* gpiod_chip_get_line(gpiod_chip* opened, unsigned int offset) {
  if (offset >= patella::test::kLines) {
    errno = EINVAL;
    return nullptr;
  }
  opened->lines.at(offset).offset = offset;
  opened->claimed.at(offset) = !chip().lines.at(offset).requested;
  return &opened->lines.at(offset);
}

int gpiod_line_request(gpiod_line* line, const gpiod_line_request_config* config, int default_value) {
  const bool output = config->request_type == GPIOD_LINE_REQUEST_DIRECTION_OUTPUT;
  if (!patella::test::claim(line->offset, output)) {
    return -1;
  }
  auto& one = chip().lines.at(line->offset);
  one.active_low = (config->flags & GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW) != 0;
  one.pull_up = (config->flags & GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP) != 0;
  one.pull_down = (config->flags & GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN) != 0;
  one.both_edges = config->request_type == GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES;
  return output ? patella::test::writeLevel(line->offset, default_value != 0) : 0;
}

int gpiod_line_event_get_fd(gpiod_line* line) {
  return chip().lines.at(line->offset).events[0];
}

int gpiod_line_get_value(gpiod_line* line) {
  return patella::test::readLevel(line->offset);
}

int gpiod_line_set_value(gpiod_line* line, int value) {
  return patella::test::writeLevel(line->offset, value != 0);
}

int gpiod_line_event_read_fd_multiple(int fd, gpiod_line_event*, unsigned int num_events) {
  return patella::test::readEdges(fd, num_events);
}
}
