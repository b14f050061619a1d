#include "tools/train/split.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "sim/random.hpp"

namespace patella::train {
namespace {

/// Deals roles by lot so that the shares come out as near as whole items allow.
std::vector<Role> dealt(std::size_t count, const SplitOptions& options, sim::Random& random) {
  const auto n = static_cast<double>(count);
  const auto wanted = [n](double share) {
    return share > 0.0 ? std::max<std::size_t>(1, static_cast<std::size_t>(std::lround(share * n))) : 0;
  };
  std::vector<Role> roles(count, Role::kTrain);
  std::size_t next = 0;
  for (const auto& [role, share] :
       {std::pair{Role::kTest, options.test_share}, std::pair{Role::kValidation, options.validation_share}}) {
    for (std::size_t i = wanted(share); i > 0 && next < count; --i) {
      roles[next++] = role;
    }
  }
  for (std::size_t i = count; i > 1; --i) {
    std::swap(roles[i - 1], roles[static_cast<std::size_t>(random.uniform() * static_cast<double>(i))]);
  }
  return roles;
}

std::size_t stepsIn(const Sequence& sequence, double seconds) {
  return static_cast<std::size_t>(std::lround(seconds * sequence.rate_Hz));
}

/// Steps after a change of role are left out.
void leaveGaps(Sequence& sequence, double gap_s) {
  const std::size_t gap = stepsIn(sequence, gap_s);
  const std::vector<Role> before = sequence.role;
  for (std::size_t i = 1; i < before.size(); ++i) {
    if (before[i] != before[i - 1]) {
      std::fill_n(sequence.role.begin() + static_cast<std::ptrdiff_t>(i), std::min(gap, before.size() - i),
                  Role::kIgnored);
    }
  }
}

void leaveEnds(Sequence& sequence, double settling_s) {
  const std::size_t ends = std::min(stepsIn(sequence, settling_s), sequence.role.size());
  std::fill_n(sequence.role.begin(), ends, Role::kIgnored);
  std::fill_n(sequence.role.rbegin(), ends, Role::kIgnored);
}

void splitBlocks(Sequence& sequence, const SplitOptions& options, sim::Random& random) {
  const std::size_t block = std::max<std::size_t>(1, stepsIn(sequence, options.block_s));
  const std::size_t count = sequence.role.size();
  const std::vector<Role> roles = dealt((count + block - 1) / block, options, random);
  for (std::size_t i = 0; i < count; ++i) {
    sequence.role[i] = roles[i / block];
  }
}

void splitInTime(Sequence& sequence, const SplitOptions& options) {
  const auto count = static_cast<double>(sequence.role.size());
  for (std::size_t i = 0; i < sequence.role.size(); ++i) {
    const double place = (static_cast<double>(i) + 0.5) / count;
    sequence.role[i] = place > 1.0 - options.test_share                              ? Role::kTest
                       : place > 1.0 - options.test_share - options.validation_share ? Role::kValidation
                                                                                     : Role::kTrain;
  }
}

void splitRecordings(std::span<Sequence> sequences, const SplitOptions& options, sim::Random& random) {
  std::vector<std::string> names;
  for (const Sequence& sequence : sequences) {
    if (std::find(names.begin(), names.end(), sequence.name) == names.end()) {
      names.push_back(sequence.name);
    }
  }
  const std::vector<Role> roles = dealt(names.size(), options, random);
  for (Sequence& sequence : sequences) {
    const auto at = std::find(names.begin(), names.end(), sequence.name) - names.begin();
    std::fill(sequence.role.begin(), sequence.role.end(), roles[static_cast<std::size_t>(at)]);
  }
}

void requireShare(std::span<const Sequence> sequences, Role role, double share, const char* name) {
  if (share > 0.0 && countOf(sequences, role) == 0) {
    throw std::invalid_argument(std::string("no step is left for ") + name +
                                ", expected more recordings, longer ones or another split");
  }
}

}  // namespace

const std::vector<std::string>& splitNames() {
  static const std::vector<std::string> names = {"random", "blocked", "chronological", "recording"};
  return names;
}

void assignRoles(std::span<Sequence> sequences, const SplitOptions& options) {
  sim::Random random(options.seed);
  if (options.kind == SplitKind::kRecording) {
    splitRecordings(sequences, options, random);
  }
  for (Sequence& sequence : sequences) {
    if (options.kind == SplitKind::kRandom) {
      sequence.role = dealt(sequence.role.size(), options, random);
    } else if (options.kind == SplitKind::kBlocked) {
      splitBlocks(sequence, options, random);
    } else if (options.kind == SplitKind::kChronological) {
      splitInTime(sequence, options);
    }
    if (options.kind != SplitKind::kRandom) {
      leaveGaps(sequence, options.gap_s);
    }
    leaveEnds(sequence, options.settling_s);
  }
  requireShare(sequences, Role::kValidation, options.validation_share, "validation");
  requireShare(sequences, Role::kTest, options.test_share, "the test");
}

void assignRole(Sequence& sequence, Role role, double settling_s) {
  std::fill(sequence.role.begin(), sequence.role.end(), role);
  leaveEnds(sequence, settling_s);
}

std::size_t countOf(std::span<const Sequence> sequences, Role role) {
  std::size_t count = 0;
  for (const Sequence& sequence : sequences) {
    count += static_cast<std::size_t>(std::count(sequence.role.begin(), sequence.role.end(), role));
  }
  return count;
}

}  // namespace patella::train
