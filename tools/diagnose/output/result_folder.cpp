#include "tools/diagnose/output/result_folder.hpp"

#include <memory>
#include <system_error>
#include <utility>

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
  tryOut(there);
}

/// Permissions alone do not tell: a folder of the kernel's takes no files, whoever asks.
void ResultFolder::tryOut(const fs::path& there) {
  made_ = true;
  try {
    fs::create_directories(path_);
    const app::AtomicFile one(path_ / "report.html");
  } catch (const std::exception& error) {
    removeMade();
    const auto* of_system = dynamic_cast<const fs::filesystem_error*>(&error);
    throw refusal(there.string() + ": " +
                  (of_system != nullptr ? of_system->code().message() : error.what()));
  }
  removeMade();
}

ResultFolder::~ResultFolder() {
  removeMade();
}

void ResultFolder::removeMade() noexcept {
  if (!std::exchange(made_, false)) {
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
