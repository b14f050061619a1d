#include <string_view>

#include <nlohmann/json.hpp>

#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/weights/safetensors_file.hpp"

namespace patella::app {

namespace {

std::string_view bytesOf(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

std::string headerText(const std::filesystem::path& path, const Safetensors& content) {
  nlohmann::json header = nlohmann::json::object();
  auto metadata = content.metadata;
  metadata[kSealKey] = kSealName;
  metadata[kSealDigestKey] = contentSha256(content);
  header["__metadata__"] = metadata;
  std::size_t begin = 0;
  for (const auto& [name, tensor] : content.tensors) {
    std::size_t elements = 1;
    for (const std::int64_t size : tensor.shape)
      elements *= static_cast<std::size_t>(size);
    if (elements != tensor.values.size())
      throw FileError(path.string() + ": tensor '" + name + "': shape " + shapeText(tensor.shape) + ", but " +
                      std::to_string(tensor.values.size()) + " values");
    const std::size_t end = begin + bytesOf(tensor.values).size();
    header[name] = {{"dtype", "F32"}, {"shape", tensor.shape}, {"data_offsets", {begin, end}}};
    begin = end;
  }
  std::string text = header.dump();
  // The format asks for data that begin on a multiple of eight bytes.
  text.resize((text.size() + 7) / 8 * 8, ' ');
  return text;
}

}  // namespace

void writeSafetensors(const std::filesystem::path& path, const Safetensors& content) {
  const std::string header = headerText(path, content);
  const std::uint64_t length = header.size();
  AtomicFile file(path);
  file.write({reinterpret_cast<const char*>(&length), sizeof(length)});
  file.write(header);
  for (const auto& [name, tensor] : content.tensors)
    file.write(bytesOf(tensor.values));
  file.commit();
}

}  // namespace patella::app
