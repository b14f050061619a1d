// Counts the periods between complete sets of samples that come in several messages.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace patella::can {

/// A set is complete when every member has a sample that no set had before. Each member tells the number of
/// its sample; only differences of these matter.
template <std::size_t kMembers>
class SampleSet {
 public:
  void bind(std::size_t member) noexcept { members_[member].bound = true; }

  void add(std::size_t member, std::int64_t sample) noexcept {
    members_[member].newest = sample;
    members_[member].fresh = true;
  }

  /// Periods since the set before; 0 where none is complete, 1 for the first.
  int take() noexcept {
    std::int64_t steps = INT32_MAX;
    bool any = false;
    for (const Member& member : members_) {
      if (!member.bound)
        continue;
      if (!member.fresh)
        return 0;
      any = true;
      steps = std::min(steps, member.newest - member.used);
    }
    if (!any)
      return 0;
    if (!started_)
      steps = 1;
    for (Member& member : members_) {
      member.fresh = false;
      // A tick may fall between the messages of one set, so a member may be one sample ahead; further ahead
      // its counter has been restarted.
      const bool restarted = member.newest - member.used - steps > 1;
      member.used = started_ && !restarted ? member.used + steps : member.newest;
    }
    started_ = true;
    return static_cast<int>(std::max<std::int64_t>(steps, 1));
  }

 private:
  struct Member {
    bool bound = false;
    bool fresh = false;
    std::int64_t newest = 0;
    std::int64_t used = 0;
  };
  std::array<Member, kMembers> members_{};
  bool started_ = false;
};

}  // namespace patella::can
