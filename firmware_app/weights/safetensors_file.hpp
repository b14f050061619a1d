// The safetensors format (github.com/huggingface/safetensors): eight bytes of little-endian header length, a
// JSON header, the tensors' bytes. Nothing in a file is trusted: every length, offset and number is checked
// before a byte of a tensor is used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace patella::app {

struct Tensor {
  std::vector<std::int64_t> shape;
  std::vector<float> values;  ///< row-major; as many as the product of the shape
};

/// "[512,5]"
std::string shapeText(const std::vector<std::int64_t>& shape);

struct Safetensors {
  std::map<std::string, Tensor> tensors;
  std::map<std::string, std::string> metadata;
};

/// F32 is taken as it is, F64 rounded to it. Throws FileError naming the file and, where there is
/// one, the tensor or key when the file cannot be read, is cut short, its header is not what the format asks
/// for, the tensors overlap or leave bytes unused, a type is another one, or a number is not finite.
Safetensors readSafetensors(const std::filesystem::path& path);

/// Writes F32. The file appears under its name only when it is whole and on the disk; on failure throws
/// FileError naming the file and leaves what was there before, and nothing else.
void writeSafetensors(const std::filesystem::path& path, const Safetensors& content);

}  // namespace patella::app
