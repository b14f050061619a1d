#include "tools/convert/run_to_mcap.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "drivers/can/candump_log.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/json_file.hpp"
#include "firmware_app/formats/mcap_reader.hpp"
#include "firmware_app/formats/mcap_run.hpp"
#include "tools/convert/run_events.hpp"
#include "tools/convert/run_rows.hpp"

namespace patella::convert {
namespace {

constexpr double kSecond_ns = 1e9;
constexpr files::FileKind kAttached{"an attachment", 64'000'000};

/// The frames of a run, the next one in sight.
class FrameStream {
 public:
  explicit FrameStream(const std::filesystem::path& file) {
    if (std::filesystem::exists(file)) {
      reader_.emplace(file);
      advance();
    }
  }
  const can::LogEntry* next() const noexcept { return more_ ? &entry_ : nullptr; }
  void advance() { more_ = reader_->next(entry_); }

 private:
  std::optional<can::CandumpReader> reader_;
  can::LogEntry entry_;
  bool more_ = false;
};

struct Summary {
  std::string text;
  formats::RunInputs inputs;
};

void attach(const std::filesystem::path& file, const std::map<std::string, std::string>& roles,
            formats::RunInputs& inputs) {
  const std::string digest = app::fileSha256(file);
  if (!roles.contains(digest)) {
    throw app::FileError(
        file.string() + ": its SHA-256 " + digest +
        " is not among the inputs of the run's summary.json, expected a file that the run was "
        "configured from");
  }
  const std::string name = file.filename().string();
  inputs.files.push_back(
      {.name = name, .media_type = formats::mediaType(name), .data = app::readFile(file, kAttached)});
}

Summary readSummary(const std::filesystem::path& run, const std::vector<std::filesystem::path>& attached) {
  Summary summary;
  summary.inputs.hashes.name = "inputs";
  std::map<std::string, std::string> roles;
  const std::filesystem::path file = run / "summary.json";
  if (std::filesystem::exists(file)) {
    summary.text = app::readFile(file, files::kResultFile);
    const nlohmann::json json = app::parseJson(summary.text, file.string());
    try {
      for (const auto& [role, input] : json.at("inputs").items()) {
        const auto digest = input.at("sha256").get<std::string>();
        roles[digest] = role;
        summary.inputs.hashes.values[role] = input.at("file").get<std::string>() + " sha256=" + digest;
      }
    } catch (const nlohmann::json::exception& error) {
      throw app::FileError(file.string() + ": inputs: " + error.what());
    }
  }
  for (const std::filesystem::path& path : attached) {
    attach(path, roles, summary.inputs);
  }
  return summary;
}

}  // namespace

McapReport convertRunToMcap(const std::filesystem::path& run,
                            const std::vector<std::filesystem::path>& attached,
                            const std::filesystem::path& mcap) {
  if (!std::filesystem::is_directory(run)) {
    throw app::FileError(run.string() + ": is no folder, expected that of a run");
  }
  Summary summary = readSummary(run, attached);
  McapReport report{.attachments = summary.inputs.files.size()};
  const std::string ticks = (run / "ticks.csv").string();
  RunRows rows(ticks);
  const auto time_column =
      std::find(rows.columns().begin(), rows.columns().end(), "t_s") - rows.columns().begin();
  FrameStream frames(run / "frames.log");
  RunEvents events(run / "events.log");
  const std::int64_t epoch_ns = frames.next() == nullptr ? 0 : frames.next()->frame.wall_ns;
  const auto at = [&](double time_s) {
    const auto wall_ns = static_cast<std::uint64_t>(epoch_ns + std::llround(time_s * kSecond_ns));
    return formats::MessageTime{.wall_ns = wall_ns, .loop_ns = wall_ns};
  };

  app::AtomicFile out(mcap);
  const auto sink = [&](std::string_view bytes) { out.write(bytes); };
  try {
    formats::McapRun writer(sink, "patella-convert " PATELLA_VERSION, rows.columns(),
                            std::move(summary.inputs));
    const auto write_frame = [&] {
      const can::LogEntry& entry = *frames.next();
      const auto wall_ns = static_cast<std::uint64_t>(entry.frame.wall_ns);
      writer.frame(entry.frame, entry.interface, {.wall_ns = wall_ns, .loop_ns = wall_ns});
      frames.advance();
      ++report.frames;
    };
    const auto write_event = [&] {
      writer.event(events.line(), at(events.time_s()));
      events.advance();
      ++report.events;
    };
    std::vector<double> row;
    while (rows.next(row)) {
      const double time_s = row[static_cast<std::size_t>(time_column)];
      const formats::MessageTime time = at(time_s);
      while (frames.next() != nullptr &&
             static_cast<std::uint64_t>(frames.next()->frame.wall_ns) <= time.wall_ns) {
        write_frame();
      }
      writer.tick(row, time);
      ++report.ticks;
      while (events.more() && events.time_s() <= time_s) {
        write_event();
      }
    }
    while (frames.next() != nullptr) {
      write_frame();
    }
    while (events.more()) {
      write_event();
    }
    writer.finish({.name = "summary", .values = {{"summary.json", summary.text}}});
  } catch (const std::invalid_argument& error) {
    throw app::FileError(ticks + ": " + error.what());
  }
  out.commit();
  return report;
}

RecoveryReport recoverMcap(const std::filesystem::path& broken, const std::filesystem::path& mcap) {
  formats::McapReader reader(broken);
  app::AtomicFile out(mcap);
  formats::McapWriter writer([&](std::string_view bytes) { out.write(bytes); },
                             "patella-convert " PATELLA_VERSION);
  std::map<std::uint16_t, std::uint16_t> schemas{{0, 0}};  // 0: a channel without one
  std::map<std::uint16_t, std::uint16_t> channels;
  RecoveryReport report;
  const auto renumbered = [&](const auto& ids, std::uint16_t id, const char* what) {
    const auto found = ids.find(id);
    if (found == ids.end()) {
      throw app::FileError(broken.string() + ": uses " + what + " " + std::to_string(id) +
                           ", which no record before it defines");
    }
    return found->second;
  };
  formats::McapRecord record;
  while (reader.next(record)) {
    if (const auto* message = std::get_if<formats::McapMessage>(&record)) {
      writer.message(renumbered(channels, message->channel, "channel"), message->log_ns, message->publish_ns,
                     message->data);
      ++report.messages;
    } else if (const auto* schema = std::get_if<formats::McapSchemaRecord>(&record)) {
      if (!schemas.contains(schema->id)) {
        schemas[schema->id] = writer.add(schema->schema);
      }
    } else if (auto* channel = std::get_if<formats::McapChannelRecord>(&record)) {
      if (!channels.contains(channel->id)) {
        channel->channel.schema = renumbered(schemas, channel->channel.schema, "schema");
        channels[channel->id] = writer.add(channel->channel);
      }
    } else if (const auto* attachment = std::get_if<formats::McapAttachment>(&record)) {
      writer.add(*attachment);
      ++report.attachments;
    } else if (const auto* metadata = std::get_if<formats::McapMetadata>(&record)) {
      writer.add(*metadata);
    }
  }
  writer.finish();
  out.commit();
  report.cut = reader.cut();
  report.read_to = reader.readTo();
  return report;
}

}  // namespace patella::convert
