// The rig's digital lines on a GPIO character device of the kernel, through libgpiod.
#pragma once

#include <atomic>
#include <optional>
#include <string>

#include "drivers/gpio/gpiod_line.hpp"
#include "drivers/gpio/pins.hpp"

namespace patella::gpio {

/// Line offsets count from zero within the chip; kNotWired leaves a function out.
struct GpiodPinsOptions {
  static constexpr int kNotWired = -1;

  std::string chip = "/dev/gpiochip0";  ///< path, or name within /dev
  int emergency_stop_line = kNotWired;
  int drive_enable_line = kNotWired;
  int heartbeat_line = kNotWired;
  int watchdog_line = kNotWired;  ///< heartbeat of the watchdog thread
  /// Pressed is the low level: a normally closed contact holds the line high.
  bool emergency_stop_active_low = true;
  /// Must not pull towards the released level, else a broken wire would go unnoticed.
  Bias emergency_stop_bias = Bias::kPullDown;
};

/// Path of a chip that is given by path or by its name within /dev.
std::string chipPath(const std::string& chip);

/// Outputs start low and are set low again, drive enable first, when the object goes. Each call in the loop
/// is one ioctl (the emergency stop: and one read of a non-blocking descriptor), without heap use; the chip
/// must be one whose lines do not sleep (memory-mapped, not behind I²C or SPI).
class GpiodPins final : public Pins {
 public:
  /// Throws std::invalid_argument for options that contradict each other, std::runtime_error naming chip,
  /// line and the system's reason when a line cannot be had.
  explicit GpiodPins(const GpiodPinsOptions& options);
  ~GpiodPins() override;
  GpiodPins(const GpiodPins&) = delete;
  GpiodPins& operator=(const GpiodPins&) = delete;

  bool emergencyStop() noexcept PATELLA_NONBLOCKING override;
  bool setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING override;
  bool setHeartbeat(bool level) noexcept PATELLA_NONBLOCKING override;
  void setWatchdogHeartbeat(bool level) noexcept override;

 private:
  bool set(std::optional<GpiodLine>& line, bool level) noexcept PATELLA_NONBLOCKING;

  std::optional<GpiodLine> emergency_stop_;
  std::optional<GpiodLine> drive_enable_;
  std::optional<GpiodLine> heartbeat_;
  std::optional<GpiodLine> watchdog_;
};

}  // namespace patella::gpio
