#include "tools/studies/paper/kept_results.hpp"

#include <nlohmann/json.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/json_file.hpp"

namespace patella::study {
namespace {

constexpr const char* kExtension = ".json";

}  // namespace

KeptResults::KeptResults(const std::filesystem::path& folder) : folder_(folder) {
  std::filesystem::create_directories(folder);
}

std::optional<nlohmann::json> KeptResults::find(const std::string& name, const std::string& settings) const {
  const std::filesystem::path path = beside(name, kExtension);
  if (!std::filesystem::exists(path)) {
    return std::nullopt;
  }
  nlohmann::json file;
  try {
    file = app::loadJson(path);
    if (file.at("settings").get<std::string>() == settings) {
      return file.at("result");
    }
  } catch (const std::exception& error) {
    throw app::FileError(path.string() + ": damaged: " + error.what() + "; remove it to have it made anew");
  }
  throw app::FileError(path.string() + ": made with other settings (" +
                       file.at("settings").get<std::string>() + "), expected " + settings +
                       "; give another --out, or remove it");
}

void KeptResults::keep(const std::string& name, const std::string& settings,
                       const nlohmann::json& result) const {
  app::writeFile(beside(name, kExtension),
                 nlohmann::json{{"settings", settings}, {"result", result}}.dump(1) + "\n");
}

std::filesystem::path KeptResults::beside(const std::string& name, const std::string& extension) const {
  return folder_ / (name + extension);
}

}  // namespace patella::study
