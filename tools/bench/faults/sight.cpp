#include "tools/bench/faults/sight.hpp"

#include <algorithm>

namespace patella::bench {
namespace {

using sim::FaultEvent;
using sim::FaultKind;
using sim::FrameChannel;

// Whether the frames that show `event` are among those that `other` does something to.
bool shareFrames(const FaultEvent& event, const FaultEvent& other) {
  switch (sim::channelGroup(event.kind)) {
    case sim::ChannelGroup::kFrames:
      return event.channel == FaultEvent::kAll || other.concerns(event.channel);
    case sim::ChannelGroup::kEncoder:
      return other.concerns(
          static_cast<int>(event.channel == 0 ? FrameChannel::kEncoder1 : FrameChannel::kEncoder2));
    case sim::ChannelGroup::kEmg:
      return other.concerns(static_cast<int>(FrameChannel::kEmg));
    default:
      return true;
  }
}

}  // namespace

// The most of `samples` that a fault which takes each with `probability` takes: more is rarer than once in a
// hundred campaigns of ten thousand runs.
int Sight::mostTaken(int samples, double probability) {
  constexpr double kRarer = 1e-6;
  double share = std::pow(1.0 - probability, samples);  // binomial, of exactly `taken`
  double more = 1.0 - share;
  int taken = 0;
  while (more > kRarer && taken < samples) {
    share *= (samples - taken) * probability / ((taken + 1) * (1.0 - probability));
    more -= share;
    ++taken;
  }
  return taken;
}

// That another fault keeps a sample from coming, or shows something else in its place.
double Sight::hidingProbability(double t) const {
  double most = 0.0;
  for (const FaultEvent& other : faults_) {
    if (&other != &event_ && other.activeAt(t) && hides(other)) {
      most = std::max(most, other.probability);
    }
  }
  return most;
}

bool Sight::hides(const FaultEvent& other) const {
  switch (other.kind) {
    case FaultKind::kEncoderFreeze:
      return sim::channelGroup(event_.kind) == sim::ChannelGroup::kEncoder && other.channel == event_.channel;
    case FaultKind::kLostFrames:
    case FaultKind::kDelayedFrames:
    case FaultKind::kReorderedFrames:
    case FaultKind::kFlippedBits:
    case FaultKind::kForgedFrames:
      return shareFrames(event_, other);
    case FaultKind::kRigStall:
    case FaultKind::kPeerRestart:
    case FaultKind::kBusOff:
    case FaultKind::kInterfaceDown:
      return true;
    default:
      return false;
  }
}

}  // namespace patella::bench
