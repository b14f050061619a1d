// Results on disk, so that an interrupted run goes on where it stopped.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

namespace patella::study {

/// One JSON file for each result, with the settings that it was made with.
class KeptResults {
 public:
  /// Makes the folder.
  explicit KeptResults(const std::filesystem::path& folder);

  /// Empty where there is none of this name. Throws app::FileError where it was made with other settings, or
  /// cannot be read.
  std::optional<nlohmann::json> find(const std::string& name, const std::string& settings) const;
  /// The file is there whole or not at all. Throws app::FileError.
  void keep(const std::string& name, const std::string& settings, const nlohmann::json& result) const;

  /// A file beside that of a result.
  std::filesystem::path beside(const std::string& name, const std::string& extension) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace patella::study
