// The stack of a thread's signal handlers.
#include "drivers/signal_stack.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tools/checkout/checkout.hpp"

using namespace patella;

namespace {

stack_t current() {
  stack_t stack{};
  sigaltstack(nullptr, &stack);
  return stack;
}

std::uintptr_t g_frame = 0;  // NOLINT: a signal handler has no other

void noteFrame(int /*signal*/) {
  g_frame = reinterpret_cast<std::uintptr_t>(__builtin_frame_address(0));
}

}  // namespace

TEST_CASE("handlers run on the stack while it is in use, and it goes as it came") {
  const stack_t before = current();
  struct sigaction action {};
  struct sigaction previous {};
  action.sa_handler = noteFrame;
  action.sa_flags = SA_ONSTACK;
  sigaction(SIGUSR1, &action, &previous);
  {
    const SignalStack stack;
    const SignalStack::InUse in_use(stack);
    const stack_t mine = current();
    CHECK((mine.ss_flags & SS_DISABLE) == 0);
    CHECK(mine.ss_size >= 64 * 1024);
    raise(SIGUSR1);
    const auto from = reinterpret_cast<std::uintptr_t>(mine.ss_sp);
    CHECK(g_frame >= from);
    CHECK(g_frame < from + mine.ss_size);
  }
  sigaction(SIGUSR1, &previous, nullptr);
  CHECK(current().ss_sp == before.ss_sp);
  CHECK(current().ss_flags == before.ss_flags);
}

TEST_CASE("the whole stack is in memory before a handler needs it, and what lies below it is not to be had") {
  const SignalStack stack;
  const SignalStack::InUse in_use(stack);
  const stack_t mine = current();
  const auto page = static_cast<std::size_t>(sysconf(_SC_PAGESIZE));
  std::vector<unsigned char> present((mine.ss_size + page - 1) / page);
  REQUIRE(mincore(mine.ss_sp, mine.ss_size, present.data()) == 0);
  for (const unsigned char one : present) {
    CHECK((one & 1U) == 1U);
  }
  // A system call that would read from there says so.
  std::array<int, 2> ends{};
  REQUIRE(pipe(ends.data()) == 0);
  CHECK(write(ends[1], mine.ss_sp, 1) == 1);
  CHECK(write(ends[1], static_cast<char*>(mine.ss_sp) - 1, 1) == -1);
  close(ends[0]);
  close(ends[1]);
}

TEST_CASE("a thread is started with a stack of its own, and does its work") {
  const stack_t ours = current();
  stack_t theirs{};
  startThread([&theirs] { theirs = current(); }).join();
  CHECK((theirs.ss_flags & SS_DISABLE) == 0);
  CHECK(theirs.ss_sp != nullptr);
  CHECK(theirs.ss_sp != ours.ss_sp);
}

TEST_CASE("no thread of the loop's process is started in another way") {
  int sources = 0;
  for (const char* folder : {"core", "drivers", "sim", "firmware_app"}) {
    const auto root = checkout::source() / folder;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root)) {
      const std::string name = entry.path().filename().string();
      if (!(name.ends_with(".cpp") || name.ends_with(".hpp")) || name == "signal_stack.cpp") {
        continue;
      }
      ++sources;
      std::ifstream stream(entry.path());
      const std::string text{std::istreambuf_iterator<char>(stream), {}};
      for (const char* way :
           {"std::thread(", "std::jthread(", "std::thread{", "std::async(", "pthread_create("}) {
        CAPTURE(entry.path().string());
        CAPTURE(way);
        CHECK(text.find(way) == std::string::npos);
      }
    }
  }
  CHECK(sources > 100);
}
