#include "drivers/gpio/gpiod_pins.hpp"

#include <set>
#include <stdexcept>

namespace patella::gpio {

namespace {

void checkOptions(const GpiodPinsOptions& options) {
  const Bias towards_released = options.emergency_stop_active_low ? Bias::kPullUp : Bias::kPullDown;
  if (options.emergency_stop_line >= 0 && options.emergency_stop_bias == towards_released) {
    throw std::invalid_argument(
        "emergency stop: the bias pulls towards the released level, so that a broken wire would not stop; "
        "use "
        "pull-down with active low, pull-up with active high, or leave the bias to the board");
  }
  std::set<int> used;
  for (const int line : {options.emergency_stop_line, options.drive_enable_line, options.heartbeat_line,
                         options.watchdog_line}) {
    if (line < GpiodPinsOptions::kNotWired) {
      throw std::invalid_argument("GPIO line " + std::to_string(line) +
                                  ": expected an offset from 0, or -1 for not wired");
    }
    if (line >= 0 && !used.insert(line).second) {
      throw std::invalid_argument("GPIO line " + std::to_string(line) + " is given two functions");
    }
  }
}

}  // namespace

std::string chipPath(const std::string& chip) {
  return chip.find('/') == std::string::npos ? "/dev/" + chip : chip;
}

GpiodPins::GpiodPins(const GpiodPinsOptions& options) {
  checkOptions(options);
  const std::string chip = chipPath(options.chip);
  // Outputs first: from here on the drive is held off whatever level the line floated at.
  if (options.drive_enable_line >= 0) {
    drive_enable_.emplace(GpiodLine::requestOutput(chip, options.drive_enable_line));
  }
  if (options.heartbeat_line >= 0) {
    heartbeat_.emplace(GpiodLine::requestOutput(chip, options.heartbeat_line));
  }
  if (options.watchdog_line >= 0) {
    watchdog_.emplace(GpiodLine::requestOutput(chip, options.watchdog_line));
  }
  if (options.emergency_stop_line >= 0) {
    emergency_stop_.emplace(GpiodLine::requestInput(
        chip, options.emergency_stop_line, options.emergency_stop_active_low, options.emergency_stop_bias));
  }
}

GpiodPins::~GpiodPins() {
  // A released line keeps its last level on most chips.
  setDriveEnable(false);
  setHeartbeat(false);
  setWatchdogHeartbeat(false);
}

bool GpiodPins::emergencyStop() noexcept PATELLA_NONBLOCKING {
  if (!emergency_stop_) {
    return false;
  }
  // Edges before level: a press between the two is seen as a level, or its edges wait for the next tick. An
  // edge of either direction means that the button was down on one side of it.
  const int edges = emergency_stop_->takeEdges();
  const int level = emergency_stop_->level();
  return edges != 0 || level != 0;
}

bool GpiodPins::setDriveEnable(bool enabled) noexcept PATELLA_NONBLOCKING {
  return set(drive_enable_, enabled);
}

bool GpiodPins::setHeartbeat(bool level) noexcept PATELLA_NONBLOCKING {
  return set(heartbeat_, level);
}

void GpiodPins::setWatchdogHeartbeat(bool level) noexcept {
  set(watchdog_, level);
}

bool GpiodPins::set(std::optional<GpiodLine>& line, bool level) noexcept PATELLA_NONBLOCKING {
  return !line || line->set(level);
}

}  // namespace patella::gpio
