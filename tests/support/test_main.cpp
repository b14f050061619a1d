// Entry point of every doctest executable. `--needs-data` turns a missing folder of recordings into
// a skipped test (exit status 77) instead of a passed one.
#define DOCTEST_CONFIG_IMPLEMENT
#include <cstdio>
#include <cstring>
#include <filesystem>

#include <doctest/doctest.h>

#include "tools/checkout/checkout.hpp"

namespace {
constexpr int kSkipped = 77;
}

int main(int argc, char** argv) {
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--needs-data") == 0 &&
        !std::filesystem::is_directory(patella::checkout::recordings())) {
      std::printf("SKIPPED: the recordings are not at %s\n", patella::checkout::recordings().c_str());
      return kSkipped;
    }
  }
  doctest::Context context(argc, argv);
  return context.run();
}
