// The numbers in the metadata of a network's weights.
#pragma once

#include <array>

#include "core/bounds/bound.hpp"

namespace patella::bounds {

// One row a line.
// clang-format off
inline constexpr std::array kWeights{
    number("rate_Hz", "Hz", 1, 20000, "the loop's highest rate, or a whole part of the encoder's"),
    whole("window", "steps", 1, 4096, "4 s at 1 kHz: the ring of keys and values that a file may ask for"),
    whole("heads", "", 1, 4096, "one for each channel of the widest layer; a divisor of the channels"),
    whole("linear_lags", "steps", 0, 4095, "within the longest window"),
    number("feature_mean", "feature's", -1e7, 1e7, "the longest run as time_s; float32 resolves no joint's signal beyond"),
    number("feature_scale", "feature's", 1e-9, 1e7, "finer than any sensor; as feature_mean"),
    number("output_mean", "rad/s² or N·m", -10000, 10000, "as estimation.delta_rad_s2"),
    number("output_scale", "rad/s² or N·m", 1e-9, 10000, "as estimation.delta_rad_s2"),
};
// clang-format on

}  // namespace patella::bounds
