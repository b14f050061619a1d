// A recorded run as one MCAP file, and MCAP files that were cut off as whole ones.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace patella::convert {

struct McapReport {
  std::size_t ticks = 0;
  std::size_t frames = 0;
  std::size_t events = 0;
  std::size_t attachments = 0;
};

/// Writes what the recorder writes as run.mcap, from the folder of a run. `attached` are files that the run
/// was configured from: each must have the SHA-256 that summary.json has of it. The run's time zero is put at
/// the stamp of its first frame, from which it differs by less than a tick. Throws std::runtime_error naming
/// file and line; nothing is left behind then.
McapReport convertRunToMcap(const std::filesystem::path& run,
                            const std::vector<std::filesystem::path>& attached,
                            const std::filesystem::path& mcap);

struct RecoveryReport {
  std::size_t messages = 0;
  std::size_t attachments = 0;
  bool cut = false;           ///< the file ended in the midst of its data
  std::uint64_t read_to = 0;  ///< end of its last whole record, bytes
};

/// Copies every whole record of an MCAP file into a new one with an index and a summary. Throws as McapReader
/// does.
RecoveryReport recoverMcap(const std::filesystem::path& broken, const std::filesystem::path& mcap);

}  // namespace patella::convert
