// Keeps the board's processor from ever being idle, below every other program.
//
// When the processor waits, QEMU advances counted time to the next timer, from a thread of its own. Where
// that thread comes late, while the processor is about to wait again, it leaves out of account what has been
// executed since the last look at the clock, and the timer comes too late by as much: tens of nanoseconds,
// on a busy host now and then (accel/tcg/icount-common.c, icount_start_warp_timer(), QEMU 7.2). A processor
// that never waits leaves nothing to advance.
#include <sched.h>

int main() {
  const sched_param lowest{};
  if (sched_setscheduler(0, SCHED_IDLE, &lowest) != 0) {
    return 1;
  }
  for (;;) {
    // As many instructions as QEMU takes in one go: each counts, only the jump costs much.
    asm volatile(
        ".rept 500\n"
        "nop\n"
        ".endr");
  }
}
