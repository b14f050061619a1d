// The thread that the loop runs on.
#pragma once

#include <atomic>
#include <functional>
#include <memory>

#include "firmware_app/loop/loop.hpp"
#include "firmware_app/realtime/realtime_setup.hpp"

namespace patella::app {

/// Runs the loop on a thread of its own, which alone becomes a real-time one, until the loop ends; meanwhile
/// `meanwhile` is called in the calling thread every 10 ms, and must not throw. Signals that are sent to the
/// process come to the loop's thread: torque ends however long a busy host lets the others wait. Throws what
/// the set-up of the thread throws; the loop has then not run.
std::unique_ptr<RealtimeSetup> runOnThread(Loop& loop, const RealtimeOptions& options,
                                           const std::atomic<bool>& stop,
                                           const std::function<void()>& meanwhile);

}  // namespace patella::app
