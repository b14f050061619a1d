#include "firmware_app/files/json_file.hpp"

#include "firmware_app/files/atomic_file.hpp"

namespace patella::app {
namespace {

constexpr int kDeepest = 16;

}  // namespace

nlohmann::json parseJson(std::string_view text, const std::string& name) {
  const auto bounded = [&](int depth, nlohmann::json::parse_event_t, const nlohmann::json&) {
    if (depth > kDeepest) {
      throw FileError(name + ": nested deeper than the " + std::to_string(kDeepest) + " levels expected");
    }
    return true;
  };
  try {
    return nlohmann::json::parse(text, bounded);
  } catch (const nlohmann::json::exception& error) {
    throw FileError(name + ": " + error.what());
  }
}

nlohmann::json loadJson(const std::filesystem::path& path) {
  return parseJson(readFile(path, files::kResultFile), path.string());
}

}  // namespace patella::app
