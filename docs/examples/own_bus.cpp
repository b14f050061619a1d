// A bus of one's own: frames travel as datagrams. One end is the loop's, the other the simulated rig's. A
// connected UDP socket serves as well as the pair of sockets here; so does anything else that can be read
// without waiting.
#include <cstdio>
#include <cstring>
#include <memory>
#include <system_error>

#include <linux/can.h>
#include <sys/socket.h>
#include <unistd.h>

#include "core/estimation/implicit_sampler.hpp"
#include "core/model/presets.hpp"
#include "core/tick/tick.hpp"
#include "drivers/can/bus.hpp"
#include "drivers/can/command_encoder.hpp"
#include "drivers/can/measurement_decoder.hpp"
#include "sim/rig.hpp"

namespace {

using namespace patella;

constexpr std::int64_t kPeriod_ns = 1'000'000;

/// Frames as the kernel lays them out (linux/can.h), one a datagram. Both functions run in the loop: they
/// wait for nothing and allocate nothing. What went wrong is counted and shows in down().
class DatagramBus final : public can::Bus {
 public:
  /// Takes ownership of a connected socket of datagrams.
  explicit DatagramBus(int socket) : socket_(socket) {}
  ~DatagramBus() override { close(socket_); }
  DatagramBus(const DatagramBus&) = delete;
  DatagramBus& operator=(const DatagramBus&) = delete;

  std::size_t receive(std::span<can::Frame> frames, std::int64_t now_ns) noexcept override {
    std::size_t count = 0;
    canfd_frame wire;
    while (count < frames.size() && recv(socket_, &wire, sizeof wire, MSG_DONTWAIT) == sizeof wire) {
      can::Frame& frame = frames[count++];
      frame = {};
      frame.id = wire.can_id & CAN_EFF_MASK;
      frame.extended = (wire.can_id & CAN_EFF_FLAG) != 0;
      frame.length = wire.len <= CANFD_MAX_DLEN ? wire.len : CANFD_MAX_DLEN;
      std::memcpy(frame.data.data(), wire.data, frame.length);
      frame.monotonic_ns = frame.wall_ns = now_ns;
    }
    statistics_.frames_received += count;
    return count;
  }

  can::SendResult send(can::Frame& frame, std::int64_t now_ns) noexcept override {
    canfd_frame wire{};
    wire.can_id = frame.id | (frame.extended ? CAN_EFF_FLAG : 0);
    wire.len = frame.length;
    std::memcpy(wire.data, frame.data.data(), frame.length);
    if (::send(socket_, &wire, sizeof wire, MSG_DONTWAIT | MSG_NOSIGNAL) != sizeof wire) {
      ++statistics_.send_failed;
      down_ = errno != EAGAIN && errno != ENOBUFS;
      return down_ ? can::SendResult::kDown : can::SendResult::kQueueFull;
    }
    frame.monotonic_ns = frame.wall_ns = now_ns;
    ++statistics_.frames_sent;
    return can::SendResult::kSent;
  }

  bool down() const noexcept override { return down_; }
  can::BusStatistics statistics() const noexcept override { return statistics_; }

 private:
  int socket_;
  bool down_ = false;
  can::BusStatistics statistics_;
};

/// Which signal is which quantity, as a bus map in TOML says it.
can::BusMap busMap() {
  can::BusMap map;
  map.bindings = {
      {"position_rad.1", "Encoder1", "Position"},      {"velocity_rad_s.1", "Encoder1", "Velocity"},
      {"position_rad.2", "Encoder2", "Position"},      {"velocity_rad_s.2", "Encoder2", "Velocity"},
      {"drive_torque_Nm.1", "DriveStatus", "Torque1"}, {"drive_torque_Nm.2", "DriveStatus", "Torque2"},
      {"operator_enable", "Operator", "Enable"}};
  map.protections = {{"Encoder1", "Counter", "Crc"},
                     {"Encoder2", "Counter", "Crc"},
                     {"DriveStatus", "Counter", "Crc"},
                     {"Operator", "Counter", "Crc"}};
  return map;
}

can::CommandMap commandMap() {
  return {.message = "TorqueCommand",
          .bindings = {{"torque_Nm.1", "", "Torque1"},
                       {"torque_Nm.2", "", "Torque2"},
                       {"enable", "", "Enable"},
                       {"state", "", "State"}},
          .protection = {"TorqueCommand", "Counter", "Crc"}};
}

tick::TickSettings holding() {
  tick::TickSettings settings;
  settings.emg.bypass = true;
  settings.gains = {.gravity = 1.0,
                    .stiffness_Nm_rad = JointVector::Constant(2, 60.0),
                    .damping_Nms_rad = JointVector::Constant(2, 6.0)};
  settings.limits.joint.fill({.torque_Nm = 60.0,
                              .torque_rate_Nm_s = 5000.0,
                              .velocity_rad_s = 6.0,
                              .q_min_rad = -2.5,
                              .q_max_rad = 2.5});
  return settings;
}

}  // namespace

int main() {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_DGRAM, 0, ends) != 0) {
    throw std::system_error(errno, std::generic_category(), "socketpair");
  }
  DatagramBus bus(ends[0]), far_end(ends[1]);

  const can::Database database = can::loadDbc(RIG_DBC);
  sim::RigOptions options;
  options.mechanism = model::adultLeg().parameters;
  options.initial_q_rad = {-1.4, -0.2};
  options.operator_buttons.enable_at_s = 0.2;
  sim::Rig rig(options, database);

  can::MeasurementDecoder decoder(database, busMap(), rig.joints());
  can::CommandEncoder encoder(database, commandMap(), rig.joints());
  tick::Tick tick(holding(), model::makeModel(model::adultLeg()),
                  std::make_unique<estimation::ImplicitSampler>(estimation::SamplerParameters{.delta = 60.0}),
                  nullptr, {}, network::OutputKind::kAcceleration);

  std::array<can::Frame, 64> frames;
  safety::State state = safety::State::kInit;
  for (std::int64_t now_ns = 0; now_ns < 2'000'000'000; now_ns += kPeriod_ns) {
    // The rig's side: what has come in, then its sensors.
    for (std::size_t i = 0, count = far_end.receive(frames, now_ns); i < count; ++i) {
      rig.accept(frames[i]);
    }
    rig.advance(now_ns);
    for (can::Frame frame; rig.pop(frame);) {
      far_end.send(frame, now_ns);
    }

    // The loop's side: a tick.
    for (std::size_t i = 0, count = bus.receive(frames, now_ns); i < count; ++i) {
      decoder.accept(frames[i]);
    }
    const can::Reading reading = decoder.finish(now_ns);
    tick::TickInput input{.measurement = reading.measurement,
                          .faults = reading.faults,
                          .complete = reading.complete,
                          .time_s = static_cast<double>(now_ns) * 1e-9};
    if (bus.down()) {
      input.faults.add(safety::Fault::kBusOff);
    }
    const tick::TickOutput& output = tick.step(input);
    can::Frame command = encoder.encode(output.command);
    if (bus.send(command, now_ns) != can::SendResult::kSent) {
      std::fprintf(stderr, "the command of %.3f s was lost\n", input.time_s);
      return 1;
    }
    tick.prepareNext();
    state = output.state;
  }
  std::printf("%llu frames received, %llu sent, state %s, knee at %.3f rad\n",
              static_cast<unsigned long long>(bus.statistics().frames_received),
              static_cast<unsigned long long>(bus.statistics().frames_sent), safety::stateName(state).data(),
              rig.plant().state().q[1]);
  const bool obeyed = rig.statistics().commands_rejected == 0 && rig.statistics().commands_accepted > 0;
  return state == safety::State::kActive && obeyed ? 0 : 1;
}
