#include "firmware_app/files/atomic_file.hpp"

#include <filesystem>
#include <stdexcept>

#include <doctest/doctest.h>

#include "tests/support/scratch_folder.hpp"

using namespace patella::app;
using patella::test::messageOf;
using patella::test::ScratchFolder;

TEST_CASE("a file appears when committed, and whole") {
  const ScratchFolder folder;
  const std::string large(3'000'000, 'x');
  AtomicFile file(folder / "out.txt");
  file.write(large);
  file.write("end");
  CHECK_FALSE(std::filesystem::exists(folder / "out.txt"));
  file.commit();
  CHECK(readFile(folder / "out.txt", patella::files::kResultFile) == large + "end");
  CHECK(folder.entries() == 1);
}

TEST_CASE("what is not committed leaves the old file and nothing else") {
  const ScratchFolder folder;
  writeFile(folder / "out.txt", "old");
  const auto interrupted = [&] {
    AtomicFile file(folder / "out.txt");
    file.write(std::string(1'000'000, 'y'));
    throw std::runtime_error("interrupted");
  };
  CHECK_THROWS_AS(interrupted(), std::runtime_error);
  CHECK(readFile(folder / "out.txt") == "old");
  CHECK(folder.entries() == 1);
}

TEST_CASE("two writers of one file do not disturb each other; the last to commit wins") {
  const ScratchFolder folder;
  AtomicFile first(folder / "out.txt");
  AtomicFile second(folder / "out.txt");
  first.write("first");
  second.write("second");
  second.commit();
  first.commit();
  CHECK(readFile(folder / "out.txt") == "first");
  CHECK(folder.entries() == 1);
}

TEST_CASE("a link to a file stays a link") {
  const ScratchFolder folder;
  writeFile(folder / "real.txt", "old");
  std::filesystem::create_symlink(folder / "real.txt", folder / "link.txt");
  writeFile(folder / "link.txt", "new");
  CHECK(std::filesystem::is_symlink(folder / "link.txt"));
  CHECK(readFile(folder / "real.txt") == "new");
}

TEST_CASE("errors name the path and the reason") {
  const ScratchFolder folder;
  const auto missing = folder / "absent/out.txt";
  CHECK(messageOf<FileError>([&] { writeFile(missing, "x"); }) ==
        missing.string() + ": cannot be created: No such file or directory");
  CHECK(messageOf<FileError>([&] { readFile(missing); }) ==
        missing.string() + ": cannot be opened: No such file or directory");
  CHECK(messageOf<FileError>([&] { readFile(folder.path()); }) ==
        folder.path().string() + ": is a directory, expected a regular file");
  CHECK(messageOf<FileError>([&] { writeFile("/dev/null", "x"); }) ==
        "/dev/null: cannot be replaced, expected a regular file or a new name");
  CHECK(folder.entries() == 0);
}

TEST_CASE("the hash is the published one") {
  // FIPS 180-2, examples B.1 and B.3.
  const ScratchFolder folder;
  writeFile(folder / "abc", "abc");
  CHECK(fileSha256(folder / "abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
  writeFile(folder / "million", std::string(1'000'000, 'a'));
  CHECK(fileSha256(folder / "million") == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
}
