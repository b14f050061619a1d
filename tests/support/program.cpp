#include "tests/support/program.hpp"

#include <fstream>
#include <iterator>
#include <sstream>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tests/unit/files/scratch_folder.hpp"

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
  std::vector<std::string> words = commandLine(executable, arguments);
  std::vector<char*> pointers;
  for (std::string& word : words) {
    pointers.push_back(word.data());
  }
  pointers.push_back(nullptr);

  const ScratchFolder folder;
  const std::filesystem::path output = folder / "output";
  const std::filesystem::path errors = folder / "errors";
  constexpr int kFlags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output.c_str(), kFlags, 0600);
  posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, errors.c_str(), kFlags, 0600);
  pid_t child = 0;
  const int error = posix_spawn(&child, pointers[0], &actions, nullptr, pointers.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  REQUIRE(error == 0);
  int status = 0;
  struct rusage usage {};
  REQUIRE(wait4(child, &status, 0, &usage) == child);

  return {.exit_status = WIFEXITED(status) ? WEXITSTATUS(status) : -1,
          .signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0,
          .output = readAll(output),
          .errors = readAll(errors),
          .peak_MB = 1e-3 * static_cast<double>(usage.ru_maxrss)};
}

}  // namespace patella::test
