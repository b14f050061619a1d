// The safetensors format (github.com/huggingface/safetensors): eight bytes of little-endian header length, a
// JSON header, the tensors' bytes. Nothing in a file is trusted: every length, offset and number is checked
// before a byte of a tensor is used.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "drivers/files/regular_file.hpp"

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
  bool sealed = false;  ///< the file had a digest, and it was the right one
};

/// Metadata that guard a file against flipped bits: a digest of all that is in it, and a word that there is
/// one, so that neither can be lost alone.
inline constexpr const char* kSealKey = "seal";
inline constexpr const char* kSealDigestKey = "seal_sha256";
inline constexpr const char* kSealName = "sha256";

/// SHA-256 over metadata and tensors, each in the order of their names, as 64 hexadecimal digits. For each
/// item of metadata but the seal: key, 0, value, 0. For each tensor: name, 0, sizes separated by commas, 0,
/// and the numbers as little-endian F32.
std::string contentSha256(const Safetensors& content);

/// F32 is taken as it is, F64 rounded to it. Throws FileError naming the file and, where there is
/// one, the tensor or key when the file cannot be read, is cut short, its header is not what the format asks
/// for, the tensors overlap or leave bytes unused, a type is another one, a number is not finite, or
/// the file is sealed and the seal does not match.
Safetensors readSafetensors(const std::filesystem::path& path,
                            const files::FileKind& kind = files::kWeightsFile);

/// Writes F32 and the seal. The file appears under its name only when it is whole and on the disk; on failure
/// throws FileError naming the file and leaves what was there before, and nothing else.
void writeSafetensors(const std::filesystem::path& path, const Safetensors& content);

}  // namespace patella::app
