#include "tools/train/output_files.hpp"

#include <stdexcept>

#include "firmware_app/files/atomic_file.hpp"

namespace patella::train {

OutputFiles outputFiles(const std::filesystem::path& weights, const std::filesystem::path& curves) {
  OutputFiles files{.weights = weights, .checkpoint = weights, .curves = curves};
  files.checkpoint += ".checkpoint";
  if (curves.empty()) {
    files.curves = std::filesystem::path(weights).replace_extension(".png");
  }
  const auto same = [&files](const std::filesystem::path& other) {
    return std::filesystem::weakly_canonical(files.curves) == std::filesystem::weakly_canonical(other);
  };
  if (same(files.weights) || same(files.checkpoint)) {
    throw std::invalid_argument("curves: value '" + files.curves.string() +
                                "', which is also a file of the weights, expected a picture of its own");
  }
  for (const auto* file : {&files.weights, &files.checkpoint, &files.curves}) {
    const app::AtomicFile tried(*file);
  }
  return files;
}

}  // namespace patella::train
