#include "firmware_app/files/toml_table.hpp"

#include <doctest/doctest.h>

#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella::app;
using patella::test::messageOf;
using patella::test::ScratchFolder;

namespace {

constexpr Range kRate{.minimum = 50, .maximum = 20000};

TomlDocument read(std::string_view text) {
  return TomlDocument::parse(text, "config.toml");
}

template <typename Action>
std::string errorOf(std::string_view text, Action&& action) {
  const TomlDocument document = read(text);
  return messageOf<FileError>([&] { action(document.root()); });
}

}  // namespace

TEST_CASE("values of every type are read") {
  const TomlDocument document = read(R"(
name = "rig"
[loop]
rate_Hz = 1000
tolerance = 0.5
count = 3
active = true
policy = "skip"
gains = [1, 2.5]
labels = ["a", "b"]
[[joint]]
limit_Nm = 10
[[joint]]
limit_Nm = 5
)");
  const TomlTable& root = document.root();
  const TomlTable loop = root.table("loop");
  const std::vector<std::string> policies{"skip", "fault"};
  CHECK(root.string("name") == "rig");
  CHECK(loop.number("rate_Hz", kRate) == 1000.0);
  CHECK(loop.number("tolerance") == 0.5);
  CHECK(loop.integer("count", 1, 10) == 3);
  CHECK(loop.boolean("active"));
  CHECK(loop.choice("policy", policies) == "skip");
  CHECK(loop.numbers("gains", CountRange::exactly(2), kPositive) == std::vector<double>{1.0, 2.5});
  CHECK(loop.strings("labels", {.minimum = 1}) == std::vector<std::string>{"a", "b"});
  REQUIRE(root.tables("joint").size() == 2);
  CHECK(root.tables("joint")[0].number("limit_Nm") == 10.0);
  CHECK(root.tables("joint")[1].number("limit_Nm") == 5.0);
  CHECK_NOTHROW(document.finish());
}

TEST_CASE("absent keys take their defaults, below absent tables too") {
  const TomlDocument document = read("");
  const TomlTable loop = document.root().optionalTable("loop");
  CHECK_FALSE(loop.present());
  CHECK(loop.number("rate_Hz", kRate, 1000.0) == 1000.0);
  CHECK(loop.integer("count", 1, 10, 4) == 4);
  CHECK(loop.boolean("active", true));
  CHECK(loop.string("name", "rig") == "rig");
  CHECK(loop.optionalTable("deeper").number("x", kAnyNumber, 2.0) == 2.0);
  CHECK(loop.tables("joint").empty());
  CHECK(messageOf<FileError>([&] { loop.number("rate_Hz", kRate); }) ==
        "config.toml:1: key 'loop.rate_Hz' is missing, expected a number in [50, 20000]");
  CHECK_NOTHROW(document.finish());
}

TEST_CASE("wrong values are refused with file, line, key, value and expectation") {
  const auto rate = [](const TomlTable& root) { root.table("loop").number("rate_Hz", kRate); };
  CHECK(errorOf("\n[loop]\nrate_Hz = 0\n", rate) ==
        "config.toml:3: key 'loop.rate_Hz': value 0, expected a number in [50, 20000]");
  CHECK(errorOf("[loop]\nrate_Hz = nan", rate) ==
        "config.toml:2: key 'loop.rate_Hz': value nan, expected a number in [50, 20000]");
  CHECK(errorOf("[loop]\nrate_Hz = \"1000\"", rate) ==
        "config.toml:2: key 'loop.rate_Hz': value '1000', expected a number in [50, 20000]");
  CHECK(
      errorOf("\n\n[loop]\nrate_hz = 1000", rate) ==
      "config.toml:3: key 'loop.rate_Hz' is missing, expected a number in [50, 20000]; there is 'rate_hz' in "
      "its place");
  CHECK(errorOf("loop = 3", rate) == "config.toml:1: key 'loop': value 3, expected a table");
  CHECK(errorOf("x = inf", [](const TomlTable& root) { root.number("x"); }) ==
        "config.toml:1: key 'x': value inf, expected a finite number");
  CHECK(errorOf("x = 0.0", [](const TomlTable& root) { root.number("x", kPositive); }) ==
        "config.toml:1: key 'x': value 0, expected a number greater than 0");
  CHECK(errorOf("x = 1.0", [](const TomlTable& root) {
          root.number("x", {.minimum = 0, .maximum = 1, .maximum_open = true});
        }) == "config.toml:1: key 'x': value 1, expected a number in [0, 1)");
  CHECK(errorOf("n = 2.5", [](const TomlTable& root) { root.integer("n", 1, 9); }) ==
        "config.toml:1: key 'n': value 2.5, expected an integer in [1, 9]");
  CHECK(errorOf("n = 10", [](const TomlTable& root) { root.integer("n", 1, 9, 5); }) ==
        "config.toml:1: key 'n': value 10, expected an integer in [1, 9]");
  CHECK(errorOf("b = 1", [](const TomlTable& root) { root.boolean("b"); }) ==
        "config.toml:1: key 'b': value 1, expected true or false");
  CHECK(errorOf("s = \"\"", [](const TomlTable& root) { root.string("s"); }) ==
        "config.toml:1: key 's': value '', expected a string that is not empty");
  CHECK(errorOf("c = \"x\"", [](const TomlTable& root) {
          root.choice("c", std::vector<std::string>{"skip", "fault"});
        }) == "config.toml:1: key 'c': value 'x', expected one of 'skip', 'fault'");
  const auto pair = [](const TomlTable& root) { root.numbers("v", CountRange::exactly(2), kPositive); };
  CHECK(errorOf("v = [1]", pair) ==
        "config.toml:1: key 'v': 1 elements, expected an array of 2 finite numbers, each greater than 0");
  CHECK(errorOf("v = [1,\n -2]", pair) ==
        "config.toml:2: key 'v': value -2, expected an array of 2 finite numbers, each greater than 0");
  CHECK(errorOf("v = 1", pair) ==
        "config.toml:1: key 'v': value 1, expected an array of 2 finite numbers, each greater than 0");
  CHECK(errorOf("e = [1]", [](const TomlTable& root) { root.tables("e"); }) ==
        "config.toml:1: key 'e': value [ 1 ], expected an array of tables");
}

TEST_CASE("syntax errors carry line and column") {
  CHECK(messageOf<FileError>([] { read("a = 1\nb = = 2\n"); }).starts_with("config.toml:2:5: "));
  CHECK(messageOf<FileError>([] { read("a = 1\na = 2\n"); }).starts_with("config.toml:2:"));
}

TEST_CASE("keys that nobody asked for are refused by name and line, with what was probably meant") {
  const TomlDocument document = read(R"(rate = 1
[loop]
rate_Hz = 1000
timeot_s = 0.1
[loop.extra]
x = 1
[[joint]]
limit_Nm = 1
[[joint]]
limit_Nm = 1
limt_Nm = 2
)");
  const TomlTable loop = document.root().table("loop");
  loop.number("rate_Hz");
  loop.number("timeout_s", kPositive, 0.1);
  for (const TomlTable& joint : document.root().tables("joint")) {
    joint.number("limit_Nm");
  }
  CHECK(messageOf<FileError>([&] { document.finish(); }) ==
        "config.toml:1: key 'rate' is unknown\n"
        "config.toml:4: key 'loop.timeot_s' is unknown, did you mean 'timeout_s'?\n"
        "config.toml:5: key 'loop.extra' is unknown\n"
        "config.toml:11: key 'joint[2].limt_Nm' is unknown, did you mean 'limit_Nm'?");
}

TEST_CASE("files are loaded, and paths in them are relative to them") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder / "models");
  writeFile(folder / "models/leg.toml", "");
  writeFile(folder / "config.toml",
            "model = \"models/leg.toml\"\nother = \"/dev/null\"\nnone = \"models/arm.toml\"\n");
  const TomlDocument document = TomlDocument::load(folder / "config.toml");
  CHECK(document.root().path("model") == folder / "models/leg.toml");
  CHECK(document.root().path("other") == "/dev/null");
  CHECK(document.root().existing("model") == folder / "models/leg.toml");
  CHECK(messageOf<FileError>([&] { document.root().existing("none"); }) ==
        (folder / "config.toml").string() + ":3: key 'none': there is no file " +
            (folder / "models/arm.toml").string() + ", expected a path from the folder of this file");
  const auto absent = folder / "absent.toml";
  CHECK(messageOf<FileError>([&] { TomlDocument::load(absent); }) ==
        absent.string() + ": cannot be opened: No such file or directory");
}

TEST_CASE("errors of the caller's own are located too") {
  const TomlDocument document = read("[loop]\na = 1\n\nb = 2\n");
  CHECK(std::string(document.root().table("loop").error("b", "must be below 'loop.a'").what()) ==
        "config.toml:4: key 'loop.b': must be below 'loop.a'");
  CHECK(document.root().table("loop").keys() == std::vector<std::string>{"a", "b"});
}
