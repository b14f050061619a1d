#include "firmware_app/files/json_file.hpp"

#include <algorithm>

#include "firmware_app/files/atomic_file.hpp"

namespace patella::app {
namespace {

constexpr int kDeepest = 16;

/// The parser counts bytes from 1, and the end of the text as one.
std::string where(std::string_view text, std::size_t byte) {
  const std::size_t before = std::min(byte == 0 ? 0 : byte - 1, text.size());
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(before), '\n');
  const std::string at = ":" + std::to_string(line) + ": ";
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    return at + "empty";
  }
  return at + (before == text.size() ? "ends too early, as a file that was cut off" : "is damaged");
}

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
  } catch (const nlohmann::json::parse_error& error) {
    throw FileError(name + where(text, error.byte) + ", expected JSON");
  } catch (const nlohmann::json::exception& error) {
    throw FileError(name + ": is no JSON that can be read (" + error.what() + ")");
  }
}

nlohmann::json loadJson(const std::filesystem::path& path) {
  return parseJson(readFile(path, files::kResultFile), path.string());
}

}  // namespace patella::app
