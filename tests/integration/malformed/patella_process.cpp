#include "tests/integration/malformed/patella_process.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <doctest/doctest.h>
#include <sys/stat.h>

#include "tools/checkout/checkout.hpp"

namespace patella::test {
namespace {

namespace fs = std::filesystem;

std::string substituted(std::string text, std::string_view mark, const std::string& value) {
  for (std::size_t at = text.find(mark); at != std::string::npos; at = text.find(mark, at + value.size())) {
    text.replace(at, mark.size(), value);
  }
  return text;
}

void expectRefusal(const Workshop& workshop, const Case& one, const std::vector<std::string>& arguments) {
  const std::set<std::string> before = workshop.listing();
  const Outcome outcome = workshop.patella(arguments);
  INFO("arguments: " << arguments.front() << "; standard error: " << outcome.errors);
  CHECK(outcome.signal == 0);
  CHECK(outcome.exit_status == 1);
  for (const std::string& phrase : one.says) {
    const std::string expected = substituted(phrase, "{line}", std::to_string(workshop.line()));
    INFO("expected: " << expected);
    CHECK(outcome.errors.find(expected) != std::string::npos);
  }
  const bool nothing_left_behind = workshop.listing() == before;
  CHECK(nothing_left_behind);
}

enum class Commands { kRunOnly, kRunAndCheck };

void expectRefusals(const std::vector<Case>& cases, Commands commands) {
  for (const Case& one : cases) {
    INFO("defect: " << std::string(one.defect));
    Workshop workshop;
    one.damage(workshop);
    std::vector<std::string> common = {"--config", workshop.file(kConfig).string()};
    for (const std::string& argument : one.arguments) {
      common.push_back(substituted(argument, "{dir}", workshop.file("").string()));
    }
    std::vector<std::string> run = {"run", "--clock", "virtual", "--duration", "0.1"};
    run.insert(run.end(), {"--out", workshop.output().string()});
    run.insert(run.end(), common.begin(), common.end());
    expectRefusal(workshop, one, run);
    if (commands == Commands::kRunAndCheck) {
      std::vector<std::string> check = {"check"};
      check.insert(check.end(), common.begin(), common.end());
      expectRefusal(workshop, one, check);
    }
  }
}

}  // namespace

Workshop::Workshop() {
  const fs::path source = checkout::source();
  for (const char* folder : {"firmware_app/config", "drivers/can"}) {
    fs::create_directories(file(folder));
  }
  fs::copy(source / "firmware_app/config", file("firmware_app/config"),
           fs::copy_options::recursive | fs::copy_options::overwrite_existing);
  fs::copy_file(source / kDbc, file(kDbc));
}

void Workshop::write(std::string_view name, std::string_view bytes) const {
  std::ofstream(file(name), std::ios::binary) << bytes;
}

std::string Workshop::read(std::string_view name) const {
  std::ifstream stream(file(name), std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

void Workshop::replace(std::string_view name, std::string_view from, std::string_view to) {
  std::string text = read(name);
  const std::size_t at = text.find(from);
  INFO(name << " holds, once: " << from);
  REQUIRE(at != std::string::npos);
  REQUIRE(text.find(from, at + 1) == std::string::npos);
  line_ = 1 + static_cast<std::size_t>(
                  std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
  text.replace(at, from.size(), to);
  write(name, text);
}

Outcome Workshop::patella(const std::vector<std::string>& arguments) const {
  return runProgram(checkout::build() / "firmware_app/patella", arguments);
}

Damage replaced(std::string name, std::string from, std::string to) {
  return [=](Workshop& workshop) { workshop.replace(name, from, to); };
}

Damage written(std::string name, std::string bytes) {
  return [=](Workshop& workshop) { workshop.write(name, bytes); };
}

Damage removed(std::string name) {
  return [=](Workshop& workshop) { REQUIRE(fs::remove(workshop.file(name))); };
}

Damage turnedIntoFolder(std::string name) {
  return [=](Workshop& workshop) {
    fs::remove(workshop.file(name));
    fs::create_directory(workshop.file(name));
  };
}

Damage linkedTo(std::string name, std::string target) {
  return [=](Workshop& workshop) {
    fs::remove(workshop.file(name));
    fs::create_symlink(target, workshop.file(name));
  };
}

Damage turnedIntoPipe(std::string name) {
  return [=](Workshop& workshop) {
    fs::remove(workshop.file(name));
    REQUIRE(mkfifo(workshop.file(name).c_str(), 0600) == 0);
  };
}

Damage none() {
  return [](Workshop&) {};
}

void expectRefused(const std::vector<Case>& cases) {
  expectRefusals(cases, Commands::kRunAndCheck);
}

void expectRunRefused(const std::vector<Case>& cases) {
  expectRefusals(cases, Commands::kRunOnly);
}

}  // namespace patella::test
