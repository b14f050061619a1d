// libgpiod 2. Its value functions are one ioctl each and its event read one read(2) into the buffer made here
// beforehand (lib/line-request.c, lib/edge-event.c): none allocates.
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <gpiod.h>

#include "drivers/gpio/gpiod_line.hpp"
#include "drivers/kernel_call.hpp"

namespace patella::gpio {

struct GpiodLine::Handle {
  gpiod_line_request* request = nullptr;
  gpiod_edge_event_buffer* events = nullptr;
  unsigned offset = 0;
};

namespace {

constexpr std::size_t kKernelQueue =
    16;  // events that the kernel keeps for a line, drivers/gpio/gpiolib-cdev.c

template <auto free_function>
struct Free {
  template <typename T>
  void operator()(T* object) const noexcept {
    free_function(object);
  }
};
using Chip = std::unique_ptr<gpiod_chip, Free<gpiod_chip_close>>;
using Settings = std::unique_ptr<gpiod_line_settings, Free<gpiod_line_settings_free>>;
using LineConfig = std::unique_ptr<gpiod_line_config, Free<gpiod_line_config_free>>;
using RequestConfig = std::unique_ptr<gpiod_request_config, Free<gpiod_request_config_free>>;

[[noreturn]] void fail(const std::string& chip_path, int offset, const char* what) {
  throw std::runtime_error("GPIO chip " + chip_path + ", line " + std::to_string(offset) + ": " + what +
                           ": " + std::generic_category().message(errno));
}

gpiod_line_bias biasSetting(Bias bias) {
  switch (bias) {
    case Bias::kPullUp:
      return GPIOD_LINE_BIAS_PULL_UP;
    case Bias::kPullDown:
      return GPIOD_LINE_BIAS_PULL_DOWN;
    case Bias::kAsIs:
      break;
  }
  return GPIOD_LINE_BIAS_AS_IS;
}

/// The request outlives the chip object that it was made through.
gpiod_line_request* request(const std::string& chip_path, int offset, gpiod_line_settings* settings) {
  const Chip chip(gpiod_chip_open(chip_path.c_str()));
  if (!chip) {
    fail(chip_path, offset, "cannot open the chip");
  }
  const LineConfig lines(gpiod_line_config_new());
  const RequestConfig config(gpiod_request_config_new());
  const unsigned number = static_cast<unsigned>(offset);
  if (!lines || !config || gpiod_line_config_add_line_settings(lines.get(), &number, 1, settings) != 0) {
    fail(chip_path, offset, "cannot describe the line");
  }
  gpiod_request_config_set_consumer(config.get(), "patella");
  gpiod_line_request* const made = gpiod_chip_request_lines(chip.get(), config.get(), lines.get());
  if (made == nullptr) {
    fail(chip_path, offset, "cannot request the line");
  }
  return made;
}

}  // namespace

void GpiodLine::Release::operator()(Handle* handle) const noexcept {
  if (handle->request != nullptr) {
    gpiod_line_request_release(handle->request);
  }
  gpiod_edge_event_buffer_free(handle->events);
  delete handle;
}

GpiodLine GpiodLine::requestInput(const std::string& chip_path, int offset, bool active_low, Bias bias) {
  const Settings settings(gpiod_line_settings_new());
  if (!settings || gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_INPUT) != 0 ||
      gpiod_line_settings_set_edge_detection(settings.get(), GPIOD_LINE_EDGE_BOTH) != 0 ||
      gpiod_line_settings_set_bias(settings.get(), biasSetting(bias)) != 0) {
    fail(chip_path, offset, "cannot describe the line");
  }
  gpiod_line_settings_set_active_low(settings.get(), active_low);
  std::unique_ptr<Handle, Release> handle(new Handle);
  handle->offset = static_cast<unsigned>(offset);
  handle->events = gpiod_edge_event_buffer_new(kKernelQueue);
  if (handle->events == nullptr) {
    fail(chip_path, offset, "cannot make the event buffer");
  }
  handle->request = request(chip_path, offset, settings.get());
  const int fd = gpiod_line_request_get_fd(handle->request);
  const int flags = fcntl(fd, F_GETFL);
  if (flags < 0 || fcntl(fd, F_SETFL, flags | O_NONBLOCK) < 0) {
    fail(chip_path, offset, "cannot make the event descriptor non-blocking");
  }
  return GpiodLine(std::move(handle));
}

GpiodLine GpiodLine::requestOutput(const std::string& chip_path, int offset) {
  const Settings settings(gpiod_line_settings_new());
  if (!settings || gpiod_line_settings_set_direction(settings.get(), GPIOD_LINE_DIRECTION_OUTPUT) != 0 ||
      gpiod_line_settings_set_output_value(settings.get(), GPIOD_LINE_VALUE_INACTIVE) != 0) {
    fail(chip_path, offset, "cannot describe the line");
  }
  std::unique_ptr<Handle, Release> handle(new Handle);
  handle->offset = static_cast<unsigned>(offset);
  handle->request = request(chip_path, offset, settings.get());
  return GpiodLine(std::move(handle));
}

int GpiodLine::level() noexcept PATELLA_NONBLOCKING {
  [[maybe_unused]] const KernelCall kernel_call;
  return gpiod_line_request_get_value(handle_->request, handle_->offset);
}

int GpiodLine::takeEdges() noexcept PATELLA_NONBLOCKING {
  [[maybe_unused]] const KernelCall kernel_call;
  const int count = gpiod_line_request_read_edge_events(handle_->request, handle_->events, kKernelQueue);
  return count < 0 && errno == EAGAIN ? 0 : count;
}

bool GpiodLine::set(bool level) noexcept PATELLA_NONBLOCKING {
  [[maybe_unused]] const KernelCall kernel_call;
  return gpiod_line_request_set_value(handle_->request, handle_->offset,
                                      level ? GPIOD_LINE_VALUE_ACTIVE : GPIOD_LINE_VALUE_INACTIVE) == 0;
}

}  // namespace patella::gpio
