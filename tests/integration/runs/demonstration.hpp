// Parts that tests of whole runs share: the demonstration's configuration, weights, and a bus that does what
// a loop must not.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "drivers/can/bus.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/recorder/loop_statistics.hpp"
#include "tests/support/scratch_folder.hpp"

namespace patella::test {

/// The demonstration, in virtual time unless told otherwise.
app::RunConfig demonstration(double duration_s, const std::string& backend = "sim",
                             const std::string& clock = "virtual");

/// Weights of the shape the paper describes (LSTM 128, dense 64, 8 heads), small random numbers, fed with the
/// states.
network::NetworkWeights randomNetwork(int lstm_layers);

/// Passes everything to another bus, and asks the heap for a block at every receive: what a loop must not do.
class AllocatingBus final : public can::Bus {
 public:
  explicit AllocatingBus(can::Bus& bus) noexcept : bus_(bus) {}
  std::size_t receive(std::span<can::Frame> frames,
                      std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override;
  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept PATELLA_NONBLOCKING override {
    return bus_.send(frame, now_ns);
  }
  bool down() const noexcept override { return bus_.down(); }
  can::BusStatistics statistics() const noexcept override { return bus_.statistics(); }

 private:
  can::Bus& bus_;
  std::unique_ptr<std::string> block_;
};

/// Runs the loop of a configuration over the lock-step rig, through an AllocatingBus where `allocating`.
app::LoopStatistics runInLockStep(const app::RunConfig& config, bool allocating);

}  // namespace patella::test
