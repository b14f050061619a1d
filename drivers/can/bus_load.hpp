// How much of the bus the loop's messages take at most.
#pragma once

#include <cstddef>
#include <span>

#include "drivers/can/bus_map.hpp"
#include "drivers/can/dbc.hpp"

namespace patella::can {

/// Bits of a data frame of so many bytes, with as many stuff bits as there can be and the pause of three bits
/// after it: g + 8n + 13 + floor((g + 8n − 1)/4), g = 34 with an identifier of 11 bits and 54 with one of 29
/// (R. I. Davis, A. Burns, R. J. Bril, J. J. Lukkien, "Controller Area Network (CAN) schedulability
/// analysis", Real-Time Systems 35, 2007). For CAN FD an upper bound, all of it at the rate of the
/// arbitration.
int mostBits(int bytes, bool extended, bool fd) noexcept;

struct BusLoad {
  double frames_per_s = 0.0;
  double bits_per_s = 0.0;
};

/// The commands at the loop's rate, with the frames by which drives enter; the messages that are read, by the
/// sensors' periods, else by the DBC's cycle time, else by the loop's rate. A multiplexed message counts once
/// for each selection that is read. What only simulated rigs send, the truth, is left out. Of several buses,
/// `bus` is the one that is asked for.
BusLoad busLoad(const Database& database, const BusMap& map, std::span<const CommandMap> commands,
                double rate_Hz, std::size_t bus = 0);

}  // namespace patella::can
