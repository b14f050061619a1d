// How long a test goes on where a sanitizer makes it several times as slow. What a sanitizer looks for shows
// in the first ticks and samples; what shows late only, ordinary builds look for.
#pragma once

namespace patella::test {

#if defined(PATELLA_SANITIZER_address) || defined(PATELLA_SANITIZER_thread) || \
    defined(PATELLA_SANITIZER_realtime)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif

template <typename Number>
constexpr Number unlessSanitized(Number whole, Number under_sanitizer) {
  return kSanitized ? under_sanitizer : whole;
}

}  // namespace patella::test
