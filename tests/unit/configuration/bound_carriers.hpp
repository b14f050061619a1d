// Sound files that between them hold every key that core/bounds has a row for.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace patella::test {

enum class FileKind { kRun, kBusMap, kModel, kFaultScript, kWeights };

struct Carrier {
  FileKind kind;
  std::string text;  ///< TOML; of weights, their metadata as one table
};

/// Model and bus map are named by their place in the source tree.
const std::vector<Carrier>& carriers();

/// Loads what stands in the text, as `patella` does. Throws what the loader throws.
void load(FileKind kind, const std::string& text, const std::filesystem::path& folder);

}  // namespace patella::test
