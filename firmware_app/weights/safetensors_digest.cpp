#include <array>
#include <string>
#include <string_view>

#include <sha2.h>

#include "drivers/joined.hpp"
#include "firmware_app/weights/safetensors_file.hpp"

namespace patella::app {
namespace {

class Digest {
 public:
  Digest() { SHA256Init(&context_); }

  void add(std::string_view bytes) {
    SHA256Update(&context_, reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
  }
  /// With an end mark, so that no two lists of texts run into the same bytes.
  void addText(const std::string& text) { add({text.c_str(), text.size() + 1}); }

  std::string text() {
    std::array<char, SHA256_DIGEST_STRING_LENGTH> digits{};
    return SHA256End(&context_, digits.data());
  }

 private:
  SHA2_CTX context_{};
};

}  // namespace

std::string contentSha256(const Safetensors& content) {
  Digest digest;
  for (const auto& [key, value] : content.metadata) {
    if (key == kSealKey || key == kSealDigestKey)
      continue;
    digest.addText(key);
    digest.addText(value);
  }
  for (const auto& [name, tensor] : content.tensors) {
    digest.addText(name);
    digest.addText(joined(tensor.shape, ",", [](std::int64_t size) { return std::to_string(size); }));
    digest.add({reinterpret_cast<const char*>(tensor.values.data()), tensor.values.size() * sizeof(float)});
  }
  return digest.text();
}

}  // namespace patella::app
