// JSON that comes from files: summaries, kept results, what metadata of weights hold.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace patella::app {

/// Throws FileError "name: ..." for what is no JSON, or is nested deeper than anything that Patella writes:
/// code that walks a document calls itself once a level.
nlohmann::json parseJson(std::string_view text, const std::string& name);

/// parseJson() of a regular file of at most files::kResultFile.
nlohmann::json loadJson(const std::filesystem::path& path);

}  // namespace patella::app
