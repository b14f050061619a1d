// The recording of a run as one MCAP file.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "firmware_app/formats/mcap_writer.hpp"
#include "firmware_app/formats/run_messages.hpp"

namespace patella::formats {

/// What a run was made of.
struct RunInputs {
  std::vector<McapAttachment> files;  ///< configuration, model, bus description, weights, as they were
  McapMetadata hashes;                ///< of those files, by their role
};

class McapRun {
 public:
  /// `columns` are those of ticks.csv. The inputs are written with the time of the first message.
  McapRun(McapWriter::Sink sink, const std::string& library, const std::vector<std::string>& columns,
          RunInputs inputs);

  void tick(std::span<const double> row, const MessageTime& time);
  void frame(const can::Frame& frame, std::string_view interface, const MessageTime& time);
  void event(std::string_view line, const MessageTime& time);
  /// Ends the file; nothing may follow.
  void finish(const McapMetadata& summary);

 private:
  void begin(std::uint64_t time_ns);

  McapWriter writer_;
  RunMessages messages_;
  RunMessages::Sink sink_;
  std::optional<RunInputs> inputs_;  ///< until they are written
};

/// The usual type of a file by its suffix, for viewers.
std::string mediaType(std::string_view file_name);

}  // namespace patella::formats
