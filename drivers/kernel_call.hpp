// Marks system calls made in the loop that are known to return at once: RealtimeSanitizer reports every ioctl
// and read, and cannot know that these descriptors never make the caller wait.
#pragma once

#include "core/types.hpp"

#if defined(__has_feature)
#if __has_feature(realtime_sanitizer)
#include <sanitizer/rtsan_interface.h>
#define PATELLA_HAS_REALTIME_SANITIZER 1
#endif
#endif

namespace patella {

#if defined(PATELLA_HAS_REALTIME_SANITIZER)
using KernelCall = __rtsan::ScopedDisabler;
#else
struct KernelCall {
  // Not defaulted: an object of this type is used for its extent only, and must not look unused.
  KernelCall() noexcept PATELLA_NONBLOCKING {}
};
#endif

}  // namespace patella
