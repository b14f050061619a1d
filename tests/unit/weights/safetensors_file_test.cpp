// The reader takes what the format allows and refuses, by name, what it does not; the writer leaves a whole
// file or none.
#include "firmware_app/weights/safetensors_file.hpp"

#include <bit>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <set>
#include <stdexcept>

#include <doctest/doctest.h>
#include <sys/resource.h>

#include "tests/support/scratch_folder.hpp"

namespace patella::app {

using test::listing;
using test::ScratchFolder;

namespace {

template <typename Number>
std::string bytes(const std::vector<Number>& numbers) {
  return {reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(Number)};
}

std::string fileOf(std::uint64_t header_length, const std::string& header, const std::string& data) {
  return bytes(std::vector{header_length}) + header + data;
}

std::string fileOf(const std::string& header, const std::string& data) {
  return fileOf(header.size(), header, data);
}

void put(const std::filesystem::path& path, const std::string& content) {
  std::ofstream(path, std::ios::binary) << content;
}

std::string get(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// The reader's message for a file of this content; its path is replaced by "file".
std::string refusal(const std::string& content) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "net.safetensors";
  put(path, content);
  try {
    readSafetensors(path);
    return "accepted";
  } catch (const std::runtime_error& error) {
    const std::string message = error.what();
    const std::string prefix = path.string() + ": ";
    return message.starts_with(prefix) ? "file: " + message.substr(prefix.size()) : message;
  }
}

const std::string kTwoFloats = bytes(std::vector{1.5F, -2.0F});

std::string oneTensor(const std::string& fields) {
  return fileOf("{\"x\":{" + fields + "}}", kTwoFloats);
}

}  // namespace

TEST_CASE("F32 and F64, scalars, empty tensors, any order and padding are read") {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "net.safetensors";
  const std::string header =
      R"({"__metadata__":{"a":"b"},"late":{"dtype":"F32","shape":[],"data_offsets":[16,20]},)"
      R"("none":{"dtype":"F32","shape":[0,3],"data_offsets":[16,16]},)"
      R"("early":{"dtype":"F64","shape":[1,2],"data_offsets":[0,16]}}   )";
  put(path, fileOf(header, bytes(std::vector{0.1, -3.0}) + bytes(std::vector{7.0F})));
  const Safetensors content = readSafetensors(path);
  CHECK(content.metadata == std::map<std::string, std::string>{{"a", "b"}});
  REQUIRE(content.tensors.size() == 3);
  CHECK(content.tensors.at("late").shape.empty());
  CHECK(content.tensors.at("late").values == std::vector{7.0F});
  CHECK(content.tensors.at("none").values.empty());
  CHECK(content.tensors.at("early").shape == std::vector<std::int64_t>{1, 2});
  CHECK(content.tensors.at("early").values == std::vector{0.1F, -3.0F});
}

TEST_CASE("a length that the file does not have is refused") {
  CHECK(refusal("") == "file: is 0 bytes long, too short for a safetensors header");
  CHECK(refusal("1234567") == "file: is 7 bytes long, too short for a safetensors header");
  CHECK(refusal(fileOf(3, "{}", "")) ==
        "file: is no safetensors file, or its end is missing: header length 3, expected at most 2");
  for (const std::uint64_t length :
       {std::uint64_t{1} << 31, std::uint64_t{1} << 63, ~std::uint64_t{0}, ~std::uint64_t{0} - 7})
    CHECK(refusal(fileOf(length, "{}", "")) ==
          "file: is no safetensors file, or its end is missing: header length " + std::to_string(length) +
              ", expected at most 2");
}

TEST_CASE("a header that is not a plain JSON object with unlike names is refused") {
  CHECK(refusal(fileOf("", "")).starts_with("file: header is not valid JSON"));
  CHECK(refusal(fileOf("{\"x\":", "")).starts_with("file: header is not valid JSON"));
  CHECK(refusal(fileOf("{\"x\xff\":1}", "")).starts_with("file: header is not valid JSON"));
  CHECK(refusal(fileOf("[]", "")) == "file: header is not a JSON object");
  CHECK(refusal(fileOf(R"({"x":7})", "")) == "file: tensor 'x': is not a JSON object");
  const std::string twice = R"("x":{"dtype":"F32","shape":[2],"data_offsets":[0,8]})";
  CHECK(refusal(fileOf("{" + twice + "," + twice + "}", kTwoFloats)) == "file: header: 'x' appears twice");
  CHECK(refusal(fileOf("{\"x\":" + std::string(100000, '['), "")) == "file: header: nested too deeply");
  CHECK(refusal(fileOf(R"({"__metadata__":[]})", "")) == "file: metadata is not a JSON object");
  CHECK(refusal(fileOf(R"({"__metadata__":{"heads":8}})", "")) == "file: metadata 'heads' is not a string");
}

TEST_CASE("another type than F32 or F64 is refused with the tensor's name") {
  CHECK(refusal(oneTensor(R"("dtype":"F16","shape":[4],"data_offsets":[0,8])")) ==
        "file: tensor 'x': type 'F16', expected F32 or F64");
  CHECK(refusal(oneTensor(R"("dtype":32,"shape":[2],"data_offsets":[0,8])")) ==
        "file: tensor 'x': type is not a string");
  CHECK(refusal(oneTensor(R"("shape":[2],"data_offsets":[0,8])")) == "file: tensor 'x': has no 'dtype'");
}

TEST_CASE("shapes and offsets that do not agree with the data are refused with the tensor's name") {
  const auto of = [](const std::string& shape, const std::string& offsets) {
    return refusal(oneTensor("\"dtype\":\"F32\",\"shape\":" + shape + ",\"data_offsets\":" + offsets));
  };
  CHECK(of("[2]", "[0,8]") == "accepted");
  CHECK(of("[3]", "[0,8]") == "file: tensor 'x': shape [3] of F32 takes 12 bytes, data_offsets hold 8");
  CHECK(of("[2]", "[0,12]") == "file: tensor 'x': data_offsets [0,12] are not within the 8 bytes of data");
  CHECK(of("[2]", "[8,0]") == "file: tensor 'x': data_offsets [8,0] are not within the 8 bytes of data");
  CHECK(of("[2]", "[-8,0]") == "file: tensor 'x': data_offsets [-8,0], expected two byte counts");
  CHECK(of("[2]", "[18446744073709551608,18446744073709551615]")
            .ends_with("are not within the 8 bytes of data"));
  CHECK(of("[2]", "[0]") == "file: tensor 'x': data_offsets [0], expected two byte counts");
  CHECK(of("[2]", "[0,8.0]") == "file: tensor 'x': data_offsets [0,8.0], expected two byte counts");
  CHECK(of("[-2]", "[0,8]") == "file: tensor 'x': shape has -2, expected a count");
  CHECK(of("2", "[0,8]") == "file: tensor 'x': shape is not an array");
  // Products that would wrap round to the right size.
  CHECK(of("[4611686018427387904,4,2]", "[0,8]") == "file: tensor 'x': shape is larger than any file");
  CHECK(of("[4294967296,4294967296]", "[0,0]") == "file: tensor 'x': shape is larger than any file");
  CHECK(of("[9223372036854775810]", "[0,8]") == "file: tensor 'x': shape is larger than any file");
}

TEST_CASE("tensors that overlap or leave bytes unused are refused") {
  const auto of = [](int begin_x, int begin_y, int floats) {
    const auto entry = [](int begin) {
      return R"({"dtype":"F32","shape":[1],"data_offsets":[)" + std::to_string(begin) + "," +
             std::to_string(begin + 4) + "]}";
    };
    return refusal(fileOf("{\"x\":" + entry(begin_x) + ",\"y\":" + entry(begin_y) + "}",
                          bytes(std::vector<float>(static_cast<std::size_t>(floats)))));
  };
  CHECK(of(4, 0, 2) == "accepted");
  CHECK(of(0, 2, 2) == "file: tensor 'y': overlaps the tensor before it: begins at byte 2, expected 4");
  CHECK(of(0, 0, 2) == "file: tensor 'y': overlaps the tensor before it: begins at byte 0, expected 4");
  CHECK(of(0, 8, 3) == "file: tensor 'y': leaves a gap before it: begins at byte 8, expected 4");
  CHECK(of(4, 8, 3) == "file: tensor 'x': leaves a gap before it: begins at byte 4, expected 0");
  CHECK(of(0, 4, 3) == "file: the tensors cover 8 of 12 bytes of data");
}

TEST_CASE("numbers that are not finite float32 are refused with the tensor's name") {
  const auto of = [](const std::string& dtype, const std::string& data) {
    return refusal(fileOf("{\"x\":{\"dtype\":\"" + dtype + "\",\"shape\":[2],\"data_offsets\":[0," +
                              std::to_string(data.size()) + "]}}",
                          data));
  };
  CHECK(of("F32", bytes(std::vector{0.0F, std::numeric_limits<float>::quiet_NaN()})) ==
        "file: tensor 'x': element 1 is not a finite float32");
  CHECK(of("F32", bytes(std::vector{-std::numeric_limits<float>::infinity(), 0.0F})) ==
        "file: tensor 'x': element 0 is not a finite float32");
  CHECK(of("F64", bytes(std::vector{0.0, 1e39})) == "file: tensor 'x': element 1 is not a finite float32");
}

TEST_CASE("what is not a readable file is refused by name") {
  const ScratchFolder folder;
  CHECK_THROWS_WITH_AS(readSafetensors(folder / "absent"),
                       doctest::Contains(((folder / "absent").string() + ": ").c_str()), std::runtime_error);
  std::filesystem::create_directory(folder / "folder");
  CHECK_THROWS_WITH_AS(readSafetensors(folder / "folder"),
                       ((folder / "folder").string() + ": is a directory, expected a regular file").c_str(),
                       std::runtime_error);
}

TEST_CASE("every truncation of a sound file is refused") {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "net.safetensors";
  writeSafetensors(path,
                   {.tensors = {{"x", {{2}, {1.0F, 2.0F}}}, {"y", {{1}, {3.0F}}}}, .metadata = {{"a", "b"}}});
  const std::string whole = get(path);
  CHECK(refusal(whole) == "accepted");
  for (std::size_t length = 0; length < whole.size(); ++length)
    CHECK(refusal(whole.substr(0, length)) != "accepted");
  CHECK(refusal(whole + "x") != "accepted");
}

TEST_CASE("what is written reads back the same, with aligned data") {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "net.safetensors";
  const Safetensors content = {
      .tensors = {{"b", {{2, 3}, {1.0F, -0.0F, 3e-45F, std::numeric_limits<float>::max(), 0.1F, -7.0F}}},
                  {"a", {{}, {5.0F}}}},
      .metadata = {{"quoted", "\"\\\n"}, {"greek", "φ"}}};
  writeSafetensors(path, content);
  std::uint64_t header_length = 0;
  std::memcpy(&header_length, get(path).data(), sizeof(header_length));
  CHECK(header_length % 8 == 0);
  const Safetensors read = readSafetensors(path);
  CHECK(read.sealed);
  CHECK(read.metadata.at(kSealDigestKey) == contentSha256(content));
  for (const auto& [key, value] : content.metadata)
    CHECK(read.metadata.at(key) == value);
  CHECK(read.metadata.size() == content.metadata.size() + 2);
  REQUIRE(read.tensors.size() == 2);
  for (const auto& [name, tensor] : content.tensors) {
    CHECK(read.tensors.at(name).shape == tensor.shape);
    CHECK(bytes(read.tensors.at(name).values) == bytes(tensor.values));
  }
  CHECK(listing(folder.path()) == std::set<std::string>{"net.safetensors"});
}

TEST_CASE("the digest is the documented one") {
  // From Python: hashlib.sha256(b"rate\0" b"1\0" b"b\0" b"2\0" + struct.pack("<2f", 1.5, -2)).hexdigest()
  const Safetensors content = {.tensors = {{"b", {{2}, {1.5F, -2.0F}}}}, .metadata = {{"rate", "1"}}};
  CHECK(contentSha256(content) == "8b593d9c369b6009a54c6271a0fb86af221f6f0b39ba3bbcbecaaee1f2d2fb3a");
}

TEST_CASE("no bit of a sealed file can be flipped unnoticed") {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "net.safetensors";
  writeSafetensors(path, {.tensors = {{"b", {{2, 2}, {1.0F, -0.5F, 0.25F, 8.0F}}}, {"a", {{1}, {5.0F}}}},
                          .metadata = {{"scale", "1.25,2"}}});
  const std::string whole = get(path);
  REQUIRE(refusal(whole) == "accepted");
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    CAPTURE(bit);
    std::string damaged = whole;
    damaged[bit / 8] = static_cast<char>(damaged[bit / 8] ^ (1 << (bit % 8)));
    CHECK(refusal(damaged) != "accepted");
  }
  std::string damaged = whole;
  damaged.back() = static_cast<char>(damaged.back() ^ 1);
  const std::string said = refusal(damaged);
  CHECK(said.starts_with("file: is damaged: its digest (metadata 'seal_sha256') is "));
  CHECK(said.find(contentSha256(readSafetensors(path))) != std::string::npos);
}

TEST_CASE("a file from elsewhere has no digest, is read, and is known for it") {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "net.safetensors";
  put(path, fileOf(R"({"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})", kTwoFloats));
  CHECK_FALSE(readSafetensors(path).sealed);
  const auto with = [](const std::string& metadata) {
    return refusal(
        fileOf("{\"__metadata__\":" + metadata + R"(,"x":{"dtype":"F32","shape":[2],"data_offsets":[0,8]}})",
               kTwoFloats));
  };
  CHECK(with(R"({"seal":"sha256"})") == "file: metadata 'seal_sha256': missing, expected as there is 'seal'");
  CHECK(with(R"({"seal_sha256":"00"})") ==
        "file: metadata 'seal': missing, expected as there is 'seal_sha256'");
  CHECK(with(R"({"seal":"md5","seal_sha256":"00"})") == "file: metadata 'seal': 'md5', expected sha256");
}

TEST_CASE("what is larger than weights are, or no file, is refused") {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "net.safetensors";
  put(path, "");
  std::filesystem::resize_file(path, 64'000'001);
  CHECK_THROWS_WITH_AS(
      readSafetensors(path),
      (path.string() + ": is 64000001 bytes long, expected at most 64000000 of weights").c_str(),
      std::runtime_error);
  CHECK_THROWS_WITH_AS(readSafetensors("/dev/zero"),
                       "/dev/zero: is a character device, expected a regular file", std::runtime_error);
}

TEST_CASE("a failed write leaves the old file and nothing else") {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "net.safetensors";
  const Safetensors old = {.tensors = {{"x", {{1}, {1.0F}}}}, .metadata = {}};
  writeSafetensors(path, old);
  const std::string before = get(path);

  // A disk that is full after four kilobytes.
  rlimit unlimited{};
  getrlimit(RLIMIT_FSIZE, &unlimited);
  const rlimit full{.rlim_cur = 4096, .rlim_max = unlimited.rlim_max};
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  setrlimit(RLIMIT_FSIZE, &full);
  const Safetensors large = {.tensors = {{"x", {{100000}, std::vector<float>(100000)}}}, .metadata = {}};
  std::string message;
  try {
    writeSafetensors(path, large);
  } catch (const std::runtime_error& error) {
    message = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &unlimited);
  std::signal(SIGXFSZ, handler);
  CHECK(message.starts_with(path.string() + ": "));
  CHECK(get(path) == before);
  CHECK(listing(folder.path()) == std::set<std::string>{"net.safetensors"});

  const std::filesystem::path nowhere = folder / "absent" / "net.safetensors";
  CHECK_THROWS_WITH_AS(writeSafetensors(nowhere, old), doctest::Contains(nowhere.string().c_str()),
                       std::runtime_error);
  std::filesystem::create_directory(folder / "taken");
  CHECK_THROWS_WITH_AS(writeSafetensors(folder / "taken", old),
                       doctest::Contains((folder / "taken").string().c_str()), std::runtime_error);
  CHECK(listing(folder.path()) == std::set<std::string>{"net.safetensors", "taken"});
}

TEST_CASE("a tensor whose values do not fill its shape is not written") {
  const ScratchFolder folder;
  const Safetensors wrong = {.tensors = {{"x", {{2, 2}, {1.0F}}}}, .metadata = {}};
  CHECK_THROWS_WITH_AS(writeSafetensors(folder / "f", wrong),
                       doctest::Contains("tensor 'x': shape [2,2], but 1 values"), std::runtime_error);
  CHECK(folder.entries() == 0);
}

}  // namespace patella::app
