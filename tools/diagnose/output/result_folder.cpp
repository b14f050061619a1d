#include "tools/diagnose/output/result_folder.hpp"

#include <memory>
#include <system_error>

#include "firmware_app/files/atomic_file.hpp"

namespace patella::diagnose {

namespace fs = std::filesystem;

ResultFolder::ResultFolder(const fs::path& path) : path_(path) {
  for (fs::path missing = fs::absolute(path).lexically_normal(); !fs::exists(missing);
       missing = missing.parent_path()) {
    made_.push_back(missing);
  }
  std::error_code error;
  fs::create_directories(path, error);
  if (error || !fs::is_directory(path)) {
    throw app::FileError(path.string() +
                         ": cannot be a folder for results: " + (error ? error.message() : "it is a file"));
  }
}

ResultFolder::~ResultFolder() {
  for (const fs::path& folder : made_) {
    std::error_code ignored;
    fs::remove(folder, ignored);
  }
}

void ResultFolder::write(const std::vector<std::pair<const char*, std::string>>& files) {
  std::vector<std::unique_ptr<app::AtomicFile>> open;
  for (const auto& [name, text] : files) {
    open.push_back(std::make_unique<app::AtomicFile>(path_ / name));
    open.back()->write(text);
  }
  for (const auto& file : open) {
    file->commit();
  }
  made_.clear();
}

}  // namespace patella::diagnose
