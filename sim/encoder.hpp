// A joint's encoder: what sampling, resolution and noise leave of angle and rate.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>

#include "sim/random.hpp"
#include "sim/random_streams.hpp"

namespace patella::sim {

struct EncoderOptions {
  int bits_per_turn = 0;  ///< 0: as fine as the bus; otherwise 4…32
  double position_noise_sd_rad = 0.0;
  double velocity_noise_sd_rad_s = 0.0;
  double velocity_step_rad_s = 0.0;  ///< resolution of the rate; 0: as fine as the bus
};

class Encoder {
 public:
  /// Throws std::invalid_argument when an option is out of its range.
  Encoder(const EncoderOptions& options, int joint, std::uint64_t seed)
      : options_(options), random_(seed, kEncoderStream + static_cast<std::uint64_t>(joint)) {
    if (options.bits_per_turn != 0 && (options.bits_per_turn < 4 || options.bits_per_turn > 32)) {
      throw std::invalid_argument("encoder bits_per_turn is " + std::to_string(options.bits_per_turn) +
                                  ", expected 0 or 4 to 32");
    }
    if (!(options.position_noise_sd_rad >= 0.0) || !(options.velocity_noise_sd_rad_s >= 0.0) ||
        !(options.velocity_step_rad_s >= 0.0)) {
      throw std::invalid_argument("encoder noise or velocity step is negative");
    }
    step_rad_ = options.bits_per_turn == 0 ? 0.0 : 2.0 * std::numbers::pi / std::exp2(options.bits_per_turn);
  }

  double measurePosition(double position_rad) noexcept {
    return rounded(position_rad + options_.position_noise_sd_rad * random_.gaussian(), step_rad_);
  }
  double measureVelocity(double velocity_rad_s) noexcept {
    return rounded(velocity_rad_s + options_.velocity_noise_sd_rad_s * random_.gaussian(),
                   options_.velocity_step_rad_s);
  }
  /// Resolution of the position, rad; 0 when unlimited.
  double step_rad() const noexcept { return step_rad_; }

 private:
  static double rounded(double value, double step) noexcept {
    return step > 0.0 ? step * std::round(value / step) : value;
  }

  EncoderOptions options_;
  Random random_;
  double step_rad_ = 0.0;
};

}  // namespace patella::sim
