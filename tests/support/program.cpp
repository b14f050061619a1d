#include "tests/support/program.hpp"

#include <fstream>
#include <iterator>
#include <sstream>

#include "tests/support/scratch_folder.hpp"
#include "tools/process/process.hpp"

namespace patella::test {
namespace {

std::string readAll(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

std::vector<std::string> commandLine(const std::string& executable,
                                     const std::vector<std::string>& arguments) {
  std::vector<std::string> words;
  std::istringstream emulator(PATELLA_EMULATOR);
  for (std::string word; emulator >> word;) {
    words.push_back(word);
  }
  words.push_back(executable);
  words.insert(words.end(), arguments.begin(), arguments.end());
  return words;
}

}  // namespace

Outcome runProgram(const std::string& executable, const std::vector<std::string>& arguments) {
  const ScratchFolder folder;
  const process::Streams streams{.output = folder / "output", .errors = folder / "errors"};
  const process::Ending ending = process::wait(process::start(commandLine(executable, arguments), streams));
  return {.exit_status = ending.exit_status,
          .signal = ending.signal,
          .output = readAll(streams.output),
          .errors = readAll(streams.errors),
          .peak_MB = ending.peak_MB};
}

}  // namespace patella::test
