// libgpiod 1.6. Its value functions are one ioctl each and its event read one read(2) into a buffer on the
// stack (lib/core.c): none allocates.
#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include <fcntl.h>
#include <gpiod.h>

#include "drivers/gpio/gpiod_line.hpp"
#include "drivers/kernel_call.hpp"

namespace patella::gpio {

struct GpiodLine::Handle {
  gpiod_chip* chip = nullptr;
  gpiod_line* line = nullptr;
  int event_fd = -1;
};

namespace {

constexpr unsigned kKernelQueue = 16;  // events that the kernel keeps for a line, drivers/gpio/gpiolib-cdev.c

[[noreturn]] void fail(const std::string& chip_path, int offset, const char* what) {
  throw std::runtime_error("GPIO chip " + chip_path + ", line " + std::to_string(offset) + ": " + what +
                           ": " + std::generic_category().message(errno));
}

int biasFlag(Bias bias) {
  switch (bias) {
    case Bias::kPullUp:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_UP;
    case Bias::kPullDown:
      return GPIOD_LINE_REQUEST_FLAG_BIAS_PULL_DOWN;
    case Bias::kAsIs:
      break;
  }
  return 0;
}

/// Opens the chip and requests the line into `handle`, which owns the chip even when this throws.
void request(gpiod_chip*& chip, gpiod_line*& line, const std::string& chip_path, int offset, int type,
             int flags) {
  chip = gpiod_chip_open(chip_path.c_str());
  if (chip == nullptr) {
    fail(chip_path, offset, "cannot open the chip");
  }
  line = gpiod_chip_get_line(chip, static_cast<unsigned>(offset));
  if (line == nullptr) {
    fail(chip_path, offset, "no such line");
  }
  const gpiod_line_request_config config{"patella", type, flags};
  if (gpiod_line_request(line, &config, 0) != 0) {
    fail(chip_path, offset, "cannot request the line");
  }
}

}  // namespace

void GpiodLine::Release::operator()(Handle* handle) const noexcept {
  if (handle->chip != nullptr) {
    gpiod_chip_close(handle->chip);  // releases its lines too
  }
  delete handle;
}

GpiodLine GpiodLine::requestInput(const std::string& chip_path, int offset, bool active_low, Bias bias) {
  std::unique_ptr<Handle, Release> handle(new Handle);
  request(handle->chip, handle->line, chip_path, offset, GPIOD_LINE_REQUEST_EVENT_BOTH_EDGES,
          biasFlag(bias) | (active_low ? GPIOD_LINE_REQUEST_FLAG_ACTIVE_LOW : 0));
  handle->event_fd = gpiod_line_event_get_fd(handle->line);
  const int flags = fcntl(handle->event_fd, F_GETFL);
  if (flags < 0 || fcntl(handle->event_fd, F_SETFL, flags | O_NONBLOCK) < 0) {
    fail(chip_path, offset, "cannot make the event descriptor non-blocking");
  }
  return GpiodLine(std::move(handle));
}

GpiodLine GpiodLine::requestOutput(const std::string& chip_path, int offset) {
  std::unique_ptr<Handle, Release> handle(new Handle);
  request(handle->chip, handle->line, chip_path, offset, GPIOD_LINE_REQUEST_DIRECTION_OUTPUT, 0);
  return GpiodLine(std::move(handle));
}

int GpiodLine::level() noexcept PATELLA_NONBLOCKING {
  [[maybe_unused]] const KernelCall kernel_call;
  return gpiod_line_get_value(handle_->line);
}

int GpiodLine::takeEdges() noexcept PATELLA_NONBLOCKING {
  [[maybe_unused]] const KernelCall kernel_call;
  std::array<gpiod_line_event, kKernelQueue> events;
  const int count = gpiod_line_event_read_fd_multiple(handle_->event_fd, events.data(), kKernelQueue);
  return count < 0 && errno == EAGAIN ? 0 : count;
}

bool GpiodLine::set(bool level) noexcept PATELLA_NONBLOCKING {
  [[maybe_unused]] const KernelCall kernel_call;
  return gpiod_line_set_value(handle_->line, level ? 1 : 0) == 0;
}

}  // namespace patella::gpio
