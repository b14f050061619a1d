// A training that could not write what it makes is refused before it begins.
#include "tools/train/output_files.hpp"

#include <fstream>
#include <stdexcept>

#include <doctest/doctest.h>

#include "firmware_app/files/file_error.hpp"
#include "tests/support/scratch_folder.hpp"

using namespace patella;
using namespace patella::train;

TEST_CASE("files of a training are named after the weights, and none is made yet") {
  const test::ScratchFolder scratch;
  const OutputFiles files = outputFiles(scratch / "w.safetensors", {});
  CHECK(files.weights == scratch / "w.safetensors");
  CHECK(files.checkpoint == scratch / "w.safetensors.checkpoint");
  CHECK(files.curves == scratch / "w.png");
  CHECK(outputFiles(scratch / "w", scratch / "losses.png").curves == scratch / "losses.png");
  CHECK(scratch.entries() == 0);
}

TEST_CASE("a picture does not take the place of the weights") {
  const test::ScratchFolder scratch;
  const auto refusal = [&](const char* weights, const std::filesystem::path& curves) {
    return test::messageOf<std::invalid_argument>([&] { outputFiles(scratch / weights, curves); });
  };
  const std::string wanted = "which is also a file of the weights, expected a picture of its own";
  CHECK(refusal("w.png", {}) == "curves: value '" + (scratch / "w.png").string() + "', " + wanted);
  CHECK(refusal("w", scratch / "." / "w").ends_with(wanted));
  CHECK(refusal("w", scratch / "w.checkpoint").ends_with(wanted));
}

TEST_CASE("a place where nothing can be written is named before the training") {
  const test::ScratchFolder scratch;
  std::filesystem::create_directory(scratch / "folder");
  const auto refusal = [&](const std::filesystem::path& weights, const std::filesystem::path& curves) {
    return test::messageOf<app::FileError>([&] { outputFiles(weights, curves); });
  };
  CHECK(refusal(scratch / "folder", {}) ==
        (scratch / "folder").string() + ": cannot be replaced, expected a regular file or a new name");
  CHECK(refusal(scratch / "none" / "w", {}) ==
        (scratch / "none" / "w").string() + ": cannot be created: No such file or directory");
  CHECK(refusal(scratch / "w", scratch / "none" / "w.png") ==
        (scratch / "none" / "w.png").string() + ": cannot be created: No such file or directory");
  std::ofstream(scratch / "w") << "an older network";
  outputFiles(scratch / "w", {});
  CHECK(std::filesystem::file_size(scratch / "w") == 16);
}
