#include "tools/convert/run_to_mcap.hpp"

#include <map>
#include <optional>
#include <utility>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/json_file.hpp"
#include "firmware_app/formats/mcap_reader.hpp"
#include "firmware_app/formats/mcap_run.hpp"
#include "tools/convert/progress.hpp"
#include "tools/convert/run_walk.hpp"

namespace patella::convert {
namespace {

constexpr files::FileKind kAttached{"an attachment", 64'000'000};

struct Summary {
  std::string text;
  std::size_t attachments = 0;
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
  summary.attachments = summary.inputs.files.size();
  return summary;
}

/// Writes what it meets on the way, and counts it.
class McapVisitor : public RunVisitor {
 public:
  McapVisitor(formats::McapWriter::Sink sink, formats::RunInputs inputs)
      : sink_(std::move(sink)), inputs_(std::move(inputs)) {}

  void begin(const std::vector<std::string>& columns) override {
    writer_.emplace(sink_, "patella-convert " PATELLA_VERSION, columns, std::move(inputs_));
  }
  void frame(const can::Frame& frame, std::string_view interface, const formats::MessageTime& time) override {
    writer_->frame(frame, interface, time);
    ++report.frames;
  }
  void tick(std::span<const double> row, const formats::MessageTime& time) override {
    writer_->tick(row, time);
    ++report.ticks;
  }
  void event(std::string_view line, const formats::MessageTime& time) override {
    writer_->event(line, time);
    ++report.events;
  }
  void finish(const std::string& summary) {
    writer_->finish({.name = "summary", .values = {{"summary.json", summary}}});
  }

  McapReport report;

 private:
  formats::McapWriter::Sink sink_;
  formats::RunInputs inputs_;
  std::optional<formats::McapRun> writer_;
};

}  // namespace

McapReport convertRunToMcap(const std::filesystem::path& run,
                            const std::vector<std::filesystem::path>& attached,
                            const std::filesystem::path& mcap) {
  Summary summary = readSummary(run, attached);
  app::AtomicFile out(mcap);
  McapVisitor visitor([&](std::string_view bytes) { out.write(bytes); }, std::move(summary.inputs));
  visitor.report.attachments = summary.attachments;
  Progress progress;
  walkRun(run, visitor, [&](double fraction) { progress.at(fraction); });
  visitor.finish(summary.text);
  out.commit();
  return visitor.report;
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
  const auto size = static_cast<double>(std::filesystem::file_size(broken));
  Progress progress;
  formats::McapRecord record;
  while (reader.next(record)) {
    progress.at(static_cast<double>(reader.readTo()) / size);
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
