#include "tools/diagnose/output/result_folder.hpp"

#include <cerrno>
#include <memory>
#include <system_error>

#include <unistd.h>

#include "firmware_app/files/atomic_file.hpp"

namespace patella::diagnose {

namespace fs = std::filesystem;

ResultFolder::ResultFolder(const fs::path& path) : path_(path) {
  const fs::path wanted = fs::absolute(path).lexically_normal();
  fs::path there = wanted;
  for (; !fs::exists(there) && there.has_relative_path(); there = there.parent_path()) {
    missing_.push_back(there);
  }
  if (!fs::is_directory(there)) {
    throw refusal(there == wanted ? "it is a file" : there.string() + " is a file");
  }
  if (access(there.c_str(), W_OK | X_OK) != 0) {
    throw refusal(there.string() + ": " + std::generic_category().message(errno));
  }
}

ResultFolder::~ResultFolder() {
  if (!made_) {
    return;
  }
  for (const fs::path& folder : missing_) {
    std::error_code ignored;
    fs::remove(folder, ignored);
  }
}

app::FileError ResultFolder::refusal(const std::string& reason) const {
  return app::FileError(path_.string() + ": cannot be a folder for results: " + reason);
}

void ResultFolder::write(const std::vector<std::pair<const char*, std::string>>& files) {
  std::error_code error;
  fs::create_directories(path_, error);
  if (error) {
    throw refusal(error.message());
  }
  made_ = true;
  std::vector<std::unique_ptr<app::AtomicFile>> open;
  for (const auto& [name, text] : files) {
    open.push_back(std::make_unique<app::AtomicFile>(path_ / name));
    open.back()->write(text);
  }
  for (const auto& file : open) {
    file->commit();
  }
  made_ = false;
}

}  // namespace patella::diagnose
