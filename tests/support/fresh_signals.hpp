// A forked child with the signals of a fresh process: the test framework has handlers of its own.
#pragma once

#include <csignal>

#include <sys/resource.h>

namespace patella::test {

/// Sets every signal from 1 to `last` to its default action, and makes no core dumps.
inline void useFreshSignals(int last) {
  for (int signal = 1; signal <= last; ++signal) {
    std::signal(signal, SIG_DFL);
  }
  const rlimit no_core_dumps{};
  setrlimit(RLIMIT_CORE, &no_core_dumps);
}

}  // namespace patella::test
