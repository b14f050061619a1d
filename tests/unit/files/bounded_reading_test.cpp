// Names that lead to no ordinary file, and files that are larger or deeper than any of their kind.
#include <ctime>
#include <fstream>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/files/line_reader.hpp"
#include "drivers/files/regular_file.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/files/json_file.hpp"
#include "firmware_app/files/toml_shape.hpp"
#include "firmware_app/files/toml_table.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella;
using namespace patella::app;
using patella::test::messageOf;
using patella::test::ScratchFolder;

namespace {

/// Of the processor's time, which a busy machine does not change; sanitizers take ten times as much.
const std::clock_t kNotSlow = 10 * CLOCKS_PER_SEC;

std::string repeated(const std::string& part, int times) {
  std::string text;
  for (int i = 0; i < times; ++i)
    text += part;
  return text;
}

std::string tomlRefusal(const std::string& text) {
  return messageOf<FileError>([&] { TomlDocument::parse(text, "x.toml"); });
}

}  // namespace

TEST_CASE("devices, pipes and folders are refused by what they are, at once") {
  const ScratchFolder folder;
  const std::string pipe = folder / "pipe";
  REQUIRE(mkfifo(pipe.c_str(), 0600) == 0);
  const auto expected = [](const std::string& name, const std::string& kind) {
    return name + ": is " + kind + ", expected a regular file";
  };
  for (const char* device : {"/dev/zero", "/dev/urandom", "/dev/null"}) {
    CHECK(messageOf<FileError>([&] { readFile(device); }) == expected(device, "a character device"));
    CHECK(messageOf<FileError>([&] { fileSha256(device); }) == expected(device, "a character device"));
    CHECK(messageOf<FileError>([&] { CsvTable::load(device); }) == expected(device, "a character device"));
    CHECK(messageOf<FileError>([&] { TomlDocument::load(device); }) ==
          expected(device, "a character device"));
  }
  CHECK(messageOf<FileError>([&] { readFile(pipe); }) == expected(pipe, "a pipe"));
  CHECK(messageOf<FileError>([&] { CsvTable::load(pipe); }) == expected(pipe, "a pipe"));
  CHECK(messageOf<FileError>([&] { fileSha256(folder.path()); }) ==
        expected(folder.path().string(), "a directory"));
}

TEST_CASE("a file longer than its kind is refused before it is read; one as long as that is taken") {
  const ScratchFolder folder;
  const files::FileKind tiny{"a test", 10};
  writeFile(folder / "ten", "0123456789");
  writeFile(folder / "eleven", "0123456789a");
  CHECK(readFile(folder / "ten", tiny) == "0123456789");
  CHECK(messageOf<FileError>([&] { readFile(folder / "eleven", tiny); }) ==
        (folder / "eleven").string() + ": is 11 bytes long, expected at most 10 of a test");
  // A terabyte that takes no room on the disk.
  const std::string huge = folder / "huge";
  writeFile(huge, "");
  REQUIRE(truncate(huge.c_str(), off_t{1} << 40) == 0);
  CHECK(messageOf<FileError>([&] { readFile(huge); }) ==
        huge + ": is 1099511627776 bytes long, expected at most 1000000 of a configuration");
  // Files of the kernel's say that they are empty, and are not.
  CHECK(readFile("/proc/self/status").find("Name:") == 0);
  CHECK(messageOf<FileError>([&] { readFile("/proc/self/status", tiny); }) ==
        "/proc/self/status: is more than 10 bytes long, expected at most 10 of a test");
}

TEST_CASE("lines are given one by one, across blocks, and one that never ends is refused") {
  const ScratchFolder folder;
  const std::string path = folder / "lines";
  const std::string long_line(99'999, 'a');
  writeFile(path, "first\n\n" + long_line + "\nlast");
  files::LineReader reader(path, 100'000);
  std::string line;
  REQUIRE(reader.next(line));
  CHECK(line == "first");
  REQUIRE(reader.next(line));
  CHECK(line.empty());
  REQUIRE(reader.next(line));
  CHECK((line == long_line));
  CHECK_FALSE(reader.unterminated());
  REQUIRE(reader.next(line));
  CHECK(line == "last");
  CHECK(reader.unterminated());
  CHECK(reader.line() == 4);
  CHECK_FALSE(reader.next(line));

  files::LineReader narrow(path, 99'998);
  CHECK(narrow.next(line));
  CHECK(narrow.next(line));
  CHECK(messageOf<std::runtime_error>([&] { narrow.next(line); }) ==
        path + ":3: the line is too long, expected at most 99998 bytes");
  writeFile(path, "t_s\n" + std::string(2'000'000, '1'));
  CHECK(messageOf<FileError>([&] { CsvTable::load(path); }) ==
        path + ":2: the line is too long, expected at most 1000000 bytes");
}

TEST_CASE("a table is the same from a file as from a text, empty lines and all") {
  const ScratchFolder folder;
  for (const std::string text :
       {"\xEF\xBB\xBFt_s,q\r\n0,1\r\n1,2", "t_s,q\n0,1\n1,2\n\r\n\n", "t_s\n0\n\n2\n"}) {
    CAPTURE(text);
    writeFile(folder / "run.csv", text);
    const CsvOptions options{.allow_missing = true};
    const CsvTable loaded = CsvTable::load(folder / "run.csv", options);
    const CsvTable parsed = CsvTable::parse(text, "run.csv", options);
    REQUIRE(loaded.names() == parsed.names());
    REQUIRE(loaded.rows() == parsed.rows());
    CHECK(loaded.column("t_s").back() == parsed.column("t_s").back());
  }
}

TEST_CASE("TOML that is nested deeper than the stack is refused with its line") {
  CHECK(tomlRefusal("# fine\nx = " + repeated("[", 100'000)) ==
        "x.toml:2: more than 16 brackets within brackets, expected at most 16");
  CHECK(tomlRefusal("x = " + repeated("{ a = ", 100'000)) ==
        "x.toml:1: more than 16 brackets within brackets, expected at most 16");
  CHECK(tomlRefusal("a" + repeated(".a", 100'000) + " = 1") ==
        "x.toml:1: more than 16 parts of a dotted key, expected at most 16");
  CHECK(tomlRefusal("\n\n[a" + repeated(" . \"b.c\"", 100'000) + "]") ==
        "x.toml:3: more than 16 parts of a dotted key, expected at most 16");
  CHECK(tomlRefusal("x = [" + repeated("1,", 300'000) + "]") ==
        "x.toml:1: more than 20000 keys and elements, expected at most 20000");
  const std::clock_t start = std::clock();
  CHECK_NOTHROW(TomlDocument::parse("x = [" + repeated("1,", 19'990) + "]", "x.toml"));
  std::string keys;
  for (int i = 0; i < 19'990; ++i)
    keys += "k" + std::to_string(i) + "=" + std::string(20, '1' + static_cast<char>(i % 9)) + "\n";
  tomlRefusal(keys);
  CHECK(std::clock() - start < kNotSlow);
}

TEST_CASE("a quote hides nothing from the scan that the parser would see") {
  const std::string deep = repeated("[", 1000);
  for (const std::string& hidden : std::vector<std::string>{
           "x = '''a''''" + deep, "x = [\"\"\"a\"\"\"\"\", " + deep, "x = [\"\", " + deep,
           "x = ['\\', " + deep, "x = [\"\\\"\", " + deep, "x = [ # \"\n" + deep, "x = \"open\n" + deep,
           "x = [\"\"\"\\\\\"\"\", " + deep}) {
    CAPTURE(hidden);
    CHECK(tomlRefusal(hidden).find("brackets within brackets") != std::string::npos);
  }
  // Brackets in strings and comments do not count.
  CHECK_NOTHROW(TomlDocument::parse("a = \"" + deep + "\" # " + deep + "\nb = '" + deep + "'\nc = '''\n" +
                                        deep + "\n'''\nd = \"\"\"\n" + deep + "\"\"\"\n",
                                    "x.toml"));
}

TEST_CASE("what nobody asked for is told up to a number") {
  std::string keys;
  for (int i = 0; i < 25; ++i)
    keys += "k" + std::to_string(i) + " = 1\n";
  const TomlDocument document = TomlDocument::parse(keys, "x.toml");
  const std::string told = messageOf<FileError>([&] { document.finish(); });
  CHECK(told.find("x.toml:20: key 'k19' is unknown\nand 5 more") != std::string::npos);
  CHECK(told.find("'k20'") == std::string::npos);
}

TEST_CASE("JSON is refused where it is damaged or nested too deeply") {
  CHECK(parseJson("{\"a\": [1, 2]}", "x.json")["a"][1] == 2);
  CHECK(messageOf<FileError>([] { parseJson("{\n\"a\": 1", "x.json"); }) ==
        "x.json:2: ends too early, as a file that was cut off, expected JSON");
  CHECK(messageOf<FileError>([] { parseJson("{\n\"a\" 1}", "x.json"); }) ==
        "x.json:2: is damaged, expected JSON");
  CHECK(messageOf<FileError>([] { parseJson("\n", "x.json"); }) == "x.json:2: empty, expected JSON");
  CHECK(messageOf<FileError>([] { parseJson(repeated("[", 100'000), "x.json"); }) ==
        "x.json: nested deeper than the 16 levels expected");
  CHECK(messageOf<FileError>([] { loadJson("/dev/zero"); }) ==
        "/dev/zero: is a character device, expected a regular file");
}
