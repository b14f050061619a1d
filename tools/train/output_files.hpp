// The files that a training leaves.
#pragma once

#include <filesystem>

namespace patella::train {

struct OutputFiles {
  std::filesystem::path weights;
  std::filesystem::path checkpoint;  ///< beside the weights, while they grow
  std::filesystem::path curves;      ///< picture
};

/// Names the files and tries each out, as a training takes hours before it writes the last. `curves` may be
/// empty: a picture beside the weights. Throws std::invalid_argument where two are one, app::FileError where
/// one cannot be written.
OutputFiles outputFiles(const std::filesystem::path& weights, const std::filesystem::path& curves);

}  // namespace patella::train
