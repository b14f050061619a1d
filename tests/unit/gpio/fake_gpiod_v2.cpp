// libgpiod 2 in front of the chip in memory; see gpiod.h for what each function promises.
#include <cerrno>

#include <gpiod.h>

#include "tests/unit/gpio/fake_gpiod.hpp"

using patella::test::chip;

struct gpiod_chip {};
struct gpiod_line_settings {
  gpiod_line_direction direction = GPIOD_LINE_DIRECTION_AS_IS;
  gpiod_line_edge edge = GPIOD_LINE_EDGE_NONE;
  gpiod_line_bias bias = GPIOD_LINE_BIAS_AS_IS;
  gpiod_line_value value = GPIOD_LINE_VALUE_INACTIVE;
  bool active_low = false;
};
struct gpiod_line_config {
  unsigned offset = 0;
  gpiod_line_settings settings;
};
struct gpiod_request_config {};
struct gpiod_line_request {
  unsigned offset = 0;
};
struct gpiod_edge_event_buffer {
  std::size_t capacity = 0;
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
  --chip().open_chips;
  delete opened;
}

gpiod_line_settings* gpiod_line_settings_new() {
  return new gpiod_line_settings;
}
void gpiod_line_settings_free(gpiod_line_settings* settings) {
  delete settings;
}
int gpiod_line_settings_set_direction(gpiod_line_settings* settings, gpiod_line_direction direction) {
  settings->direction = direction;
  return 0;
}
int gpiod_line_settings_set_edge_detection(gpiod_line_settings* settings, gpiod_line_edge edge) {
  settings->edge = edge;
  return 0;
}
int gpiod_line_settings_set_bias(gpiod_line_settings* settings, gpiod_line_bias bias) {
  settings->bias = bias;
  return 0;
}
void gpiod_line_settings_set_active_low(gpiod_line_settings* settings, bool active_low) {
  settings->active_low = active_low;
}
int gpiod_line_settings_set_output_value(gpiod_line_settings* settings, gpiod_line_value value) {
  settings->value = value;
  return 0;
}

gpiod_line_config* gpiod_line_config_new() {
  return new gpiod_line_config;
}
void gpiod_line_config_free(gpiod_line_config* config) {
  delete config;
}
int gpiod_line_config_add_line_settings(gpiod_line_config* config, const unsigned int* offsets,
                                        std::size_t num_offsets, gpiod_line_settings* settings) {
  if (num_offsets != 1) {
    errno = EINVAL;
    return -1;
  }
  *config = {offsets[0], *settings};
  return 0;
}

gpiod_request_config* gpiod_request_config_new() {
  return new gpiod_request_config;
}
void gpiod_request_config_free(gpiod_request_config* config) {
  delete config;
}
void gpiod_request_config_set_consumer(gpiod_request_config*, const char*) {}

gpiod_line_request* gpiod_chip_request_lines(gpiod_chip*, gpiod_request_config*, gpiod_line_config* config) {
  if (config->offset >= patella::test::kLines) {
    errno = EINVAL;
    return nullptr;
  }
  const gpiod_line_settings& settings = config->settings;
  const bool output = settings.direction == GPIOD_LINE_DIRECTION_OUTPUT;
  if (!patella::test::claim(config->offset, output)) {
    return nullptr;
  }
  auto& one = chip().lines.at(config->offset);
  one.active_low = settings.active_low;
  one.pull_up = settings.bias == GPIOD_LINE_BIAS_PULL_UP;
  one.pull_down = settings.bias == GPIOD_LINE_BIAS_PULL_DOWN;
  one.both_edges = settings.edge == GPIOD_LINE_EDGE_BOTH;
  if (output) {
    patella::test::writeLevel(config->offset, settings.value == GPIOD_LINE_VALUE_ACTIVE);
  }
  return new gpiod_line_request{config->offset};
}

void gpiod_line_request_release(gpiod_line_request* request) {
  patella::test::release(request->offset);
  delete request;
}
int gpiod_line_request_get_fd(gpiod_line_request* request) {
  return chip().lines.at(request->offset).events[0];
}
gpiod_line_value gpiod_line_request_get_value(gpiod_line_request*, unsigned int offset) {
  return static_cast<gpiod_line_value>(patella::test::readLevel(offset));
}
int gpiod_line_request_set_value(gpiod_line_request*, unsigned int offset, gpiod_line_value value) {
  return patella::test::writeLevel(offset, value == GPIOD_LINE_VALUE_ACTIVE);
}

gpiod_edge_event_buffer* gpiod_edge_event_buffer_new(std::size_t capacity) {
  return new gpiod_edge_event_buffer{capacity};
}
void gpiod_edge_event_buffer_free(gpiod_edge_event_buffer* buffer) {
  delete buffer;
}
int gpiod_line_request_read_edge_events(gpiod_line_request* request, gpiod_edge_event_buffer* buffer,
                                        std::size_t max_events) {
  const std::size_t most = max_events < buffer->capacity ? max_events : buffer->capacity;
  return patella::test::readEdges(gpiod_line_request_get_fd(request), static_cast<unsigned>(most));
}
}
