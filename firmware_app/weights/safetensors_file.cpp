#include "firmware_app/weights/safetensors_file.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <utility>

#include <nlohmann/json.hpp>

#include "firmware_app/files/file_error.hpp"

namespace patella::app {

namespace {

using nlohmann::json;

static_assert(std::endian::native == std::endian::little, "the file's numbers are little-endian");

constexpr std::uint64_t kLengthBytes = 8;
/// Some hundred bytes a tensor, and a model card with the losses of some ten thousand epochs.
constexpr std::uint64_t kMaxHeaderBytes = 8'000'000;
constexpr const char* kMetadataKey = "__metadata__";

/// Adds the file's name, and the tensor's, to what went wrong.
class Context {
 public:
  explicit Context(std::string subject) : subject_(std::move(subject)) {}
  Context tensor(const std::string& name) const { return Context(subject_ + ": tensor '" + name + "'"); }
  [[noreturn]] void fail(const std::string& what) const { throw FileError(subject_ + ": " + what); }

 private:
  std::string subject_;
};

struct Entry {
  std::string name;
  std::string dtype;
  std::vector<std::int64_t> shape;
  std::uint64_t begin = 0;
  std::uint64_t end = 0;
  std::uint64_t elements = 0;
};

/// Refuses repeated keys, which JSON parsers otherwise drop silently, and nesting deeper than the format's.
class StrictKeys {
 public:
  explicit StrictKeys(const Context& context) : context_(context) {}

  bool operator()(int depth, json::parse_event_t event, json& parsed) {
    constexpr int kDeepest = 3;
    if (depth > kDeepest)
      context_.fail("header: nested too deeply");
    if (event == json::parse_event_t::object_start)
      open_.emplace_back();
    else if (event == json::parse_event_t::object_end)
      open_.pop_back();
    else if (event == json::parse_event_t::key && !open_.back().insert(parsed.get<std::string>()).second)
      context_.fail("header: '" + parsed.get<std::string>() + "' appears twice");
    return true;
  }

 private:
  const Context& context_;
  std::vector<std::set<std::string>> open_;
};

json parseHeader(const Context& context, std::string_view text) {
  // The parser would take it for the end and leave what follows unread.
  if (text.find('\0') != std::string_view::npos)
    context.fail("header is not valid JSON: it holds a zero byte");
  json header;
  try {
    header = json::parse(text, StrictKeys(context));
  } catch (const json::exception& error) {
    context.fail(std::string("header is not valid JSON: ") + error.what());
  }
  if (!header.is_object())
    context.fail("header is not a JSON object");
  return header;
}

std::map<std::string, std::string> metadataOf(const Context& context, const json& value) {
  if (!value.is_object())
    context.fail("metadata is not a JSON object");
  std::map<std::string, std::string> metadata;
  for (const auto& [key, text] : value.items()) {
    if (!text.is_string())
      context.fail("metadata '" + key + "' is not a string");
    metadata[key] = text.get<std::string>();
  }
  return metadata;
}

const json& field(const Context& context, const json& value, const char* key) {
  const auto found = value.find(key);
  if (found == value.end())
    context.fail(std::string("has no '") + key + "'");
  return *found;
}

std::uint64_t byteSize(const Context& context, const std::string& dtype) {
  if (dtype == "F32")
    return sizeof(float);
  if (dtype == "F64")
    return sizeof(double);
  context.fail("type '" + dtype + "', expected F32 or F64");
}

void readShape(const Context& context, const json& shape, Entry& entry) {
  if (!shape.is_array())
    context.fail("shape is not an array");
  entry.elements = 1;
  for (const json& size : shape) {
    constexpr auto kMax =
        static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()) / sizeof(double);
    if (!size.is_number_unsigned())
      context.fail("shape has " + size.dump() + ", expected a count");
    const auto count = size.get<std::uint64_t>();
    if (count > kMax || (count != 0 && entry.elements > kMax / count))
      context.fail("shape is larger than any file");
    entry.elements *= count;
    entry.shape.push_back(static_cast<std::int64_t>(count));
  }
}

Entry readEntry(const Context& context, const std::string& name, const json& value,
                std::uint64_t data_bytes) {
  if (!value.is_object())
    context.fail("is not a JSON object");
  Entry entry;
  entry.name = name;
  const json& dtype = field(context, value, "dtype");
  if (!dtype.is_string())
    context.fail("type is not a string");
  entry.dtype = dtype.get<std::string>();
  const std::uint64_t size = byteSize(context, entry.dtype);
  readShape(context, field(context, value, "shape"), entry);
  const json& offsets = field(context, value, "data_offsets");
  if (!offsets.is_array() || offsets.size() != 2 || !offsets[0].is_number_unsigned() ||
      !offsets[1].is_number_unsigned())
    context.fail("data_offsets " + offsets.dump() + ", expected two byte counts");
  entry.begin = offsets[0].get<std::uint64_t>();
  entry.end = offsets[1].get<std::uint64_t>();
  if (entry.begin > entry.end || entry.end > data_bytes)
    context.fail("data_offsets " + offsets.dump() + " are not within the " + std::to_string(data_bytes) +
                 " bytes of data");
  if (entry.end - entry.begin != entry.elements * size)
    context.fail("shape " + shapeText(entry.shape) + " of " + entry.dtype + " takes " +
                 std::to_string(entry.elements * size) + " bytes, data_offsets hold " +
                 std::to_string(entry.end - entry.begin));
  return entry;
}

/// The tensors must cover the data without overlap and without holes.
void checkCoverage(const Context& context, std::vector<Entry>& entries, std::uint64_t data_bytes) {
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::pair(a.begin, a.end) < std::pair(b.begin, b.end);
  });
  std::uint64_t covered = 0;
  for (const Entry& entry : entries) {
    if (entry.begin != covered)
      context.tensor(entry.name)
          .fail(std::string(entry.begin < covered ? "overlaps the tensor before it"
                                                  : "leaves a gap before it") +
                ": begins at byte " + std::to_string(entry.begin) + ", expected " + std::to_string(covered));
    covered = entry.end;
  }
  if (covered != data_bytes)
    context.fail("the tensors cover " + std::to_string(covered) + " of " + std::to_string(data_bytes) +
                 " bytes of data");
}

template <typename Number>
std::vector<float> numbersOf(const Context& context, const Entry& entry, const char* data) {
  std::vector<float> values(entry.elements);
  for (std::size_t i = 0; i < values.size(); ++i) {
    Number number;
    std::memcpy(&number, data + entry.begin + i * sizeof(Number), sizeof(Number));
    if (!(std::abs(number) <= static_cast<Number>(std::numeric_limits<float>::max())))
      context.fail("element " + std::to_string(i) + " is not a finite float32");
    values[i] = static_cast<float>(number);
  }
  return values;
}

/// The whole file, which is long enough to have a header.
std::string readBytes(const std::filesystem::path& path, const files::FileKind& kind) {
  std::string bytes;
  try {
    bytes = files::readWhole(path, kind);
  } catch (const std::runtime_error& error) {
    throw FileError(error.what());
  }
  if (bytes.size() < kLengthBytes) {
    Context(path.string())
        .fail("is " + std::to_string(bytes.size()) + " bytes long, too short for a safetensors header");
  }
  return bytes;
}

void checkSeal(const Context& context, Safetensors& content) {
  const auto find = [&](const char* key) {
    const auto found = content.metadata.find(key);
    return found == content.metadata.end() ? nullptr : &found->second;
  };
  const std::string* const seal = find(kSealKey);
  const std::string* const stored = find(kSealDigestKey);
  if (seal == nullptr && stored == nullptr)
    return;
  if (seal == nullptr || stored == nullptr) {
    context.fail(std::string("metadata '") + (seal == nullptr ? kSealKey : kSealDigestKey) +
                 "': missing, expected as there is '" + (seal == nullptr ? kSealDigestKey : kSealKey) + "'");
  }
  if (*seal != kSealName)
    context.fail(std::string("metadata '") + kSealKey + "': '" + *seal + "', expected " + kSealName);
  const std::string computed = contentSha256(content);
  if (*stored != computed) {
    context.fail("is damaged: its digest (metadata '" + std::string(kSealDigestKey) + "') is " + *stored +
                 ", but that of its content is " + computed);
  }
  content.sealed = true;
}

}  // namespace

std::string shapeText(const std::vector<std::int64_t>& shape) {
  std::string text = "[";
  for (const std::int64_t size : shape)
    text += (text.size() > 1 ? "," : "") + std::to_string(size);
  return text + "]";
}

Safetensors readSafetensors(const std::filesystem::path& path, const files::FileKind& kind) {
  const Context context(path.string());
  const std::string bytes = readBytes(path, kind);
  const std::uint64_t behind_length = bytes.size() - kLengthBytes;
  std::uint64_t header_bytes = 0;
  std::memcpy(&header_bytes, bytes.data(), kLengthBytes);
  if (header_bytes > std::min(kMaxHeaderBytes, behind_length))
    context.fail("is no safetensors file, or its end is missing: header length " +
                 std::to_string(header_bytes) + ", expected at most " +
                 std::to_string(std::min(kMaxHeaderBytes, behind_length)));
  const json header = parseHeader(context, std::string_view(bytes).substr(kLengthBytes, header_bytes));
  const std::uint64_t data_bytes = behind_length - header_bytes;

  Safetensors content;
  std::vector<Entry> entries;
  for (const auto& [name, value] : header.items()) {
    if (name == kMetadataKey)
      content.metadata = metadataOf(context, value);
    else
      entries.push_back(readEntry(context.tensor(name), name, value, data_bytes));
  }
  checkCoverage(context, entries, data_bytes);

  const char* const data = bytes.data() + kLengthBytes + header_bytes;
  for (const Entry& entry : entries) {
    const Context of_tensor = context.tensor(entry.name);
    content.tensors[entry.name] = {entry.shape, entry.dtype == "F32"
                                                    ? numbersOf<float>(of_tensor, entry, data)
                                                    : numbersOf<double>(of_tensor, entry, data)};
  }
  checkSeal(context, content);
  return content;
}

}  // namespace patella::app
