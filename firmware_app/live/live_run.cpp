#include "firmware_app/live/live_run.hpp"

#include <nlohmann/json.hpp>

#include "firmware_app/files/json_file.hpp"

namespace patella::live {
namespace {

std::string describe(const std::vector<formats::ChannelDescription>& channels) {
  nlohmann::json list = nlohmann::json::array();
  for (const formats::ChannelDescription& channel : channels) {
    list.push_back({{"topic", channel.topic},
                    {"type", channel.type},
                    {"definition", channel.definition},
                    {"columns", channel.columns}});
  }
  return nlohmann::json{{"channels", list}}.dump();
}

std::string nameAfterTidying(const std::filesystem::path& folder) {
  removeLeftRings();
  return ringName(folder);
}

}  // namespace

LiveRun::LiveRun(const std::filesystem::path& folder, const std::vector<std::string>& columns)
    : messages_(columns),
      ring_(nameAfterTidying(folder), describe(messages_.channels())),
      sink_([this](formats::RunChannel channel, const formats::MessageTime& time, std::string_view message) {
        ring_.write(static_cast<std::uint16_t>(channel), time.wall_ns, message);
      }) {}

std::vector<formats::ChannelDescription> channelsOf(const std::string& description) {
  std::vector<formats::ChannelDescription> channels;
  try {
    const nlohmann::json json = app::parseJson(description, "description of the run");
    for (const auto& channel : json.at("channels")) {
      channels.push_back(
          {channel.at("topic"), channel.at("type"), channel.at("definition"), channel.at("columns")});
    }
  } catch (const nlohmann::json::exception& error) {
    throw std::runtime_error(std::string("description of the run: ") + error.what());
  }
  return channels;
}

}  // namespace patella::live
