// The shipped configuration in a folder of its own, to be damaged, and `patella` run on it as a user runs it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/program.hpp"
#include "tests/support/scratch_folder.hpp"

namespace patella::test {

/// A temporary folder with the shipped configuration, models, bus map and DBC, laid out as in the repository.
class Workshop {
 public:
  Workshop();

  std::filesystem::path file(std::string_view name) const { return folder_.path() / name; }
  std::filesystem::path output() const { return file("out"); }

  void write(std::string_view name, std::string_view bytes) const;
  std::string read(std::string_view name) const;
  /// Replaces the only place where `from` stands, and remembers its line. Fails the test case where there is
  /// none.
  void replace(std::string_view name, std::string_view from, std::string_view to);
  /// Line of the newest replacement, from 1.
  std::size_t line() const noexcept { return line_; }

  /// Paths of everything in the folder.
  std::set<std::string> listing() const { return test::listing(folder_.path()); }
  Outcome patella(const std::vector<std::string>& arguments) const;

 private:
  ScratchFolder folder_;
  std::size_t line_ = 0;
};

using Damage = std::function<void(Workshop&)>;

/// Damages of one place, file names as in Workshop::file().
Damage replaced(std::string name, std::string from, std::string to);
Damage written(std::string name, std::string bytes);
Damage removed(std::string name);
Damage turnedIntoFolder(std::string name);
/// The file's name leads to something else: a device, another file.
Damage linkedTo(std::string name, std::string target);
Damage turnedIntoPipe(std::string name);
Damage none();

struct Case {
  const char* defect;
  Damage damage;
  std::vector<std::string> says;       ///< all of them in standard error; {line} is the damaged line
  std::vector<std::string> arguments;  ///< besides --config and --out; {dir} is the workshop's folder
};

/// Runs `patella run` and `patella check` on each damaged workshop: both refuse with status 1 and say what is
/// wrong and where, and no file is left behind.
void expectRefused(const std::vector<Case>& cases);
/// As above for what only running can find out.
void expectRunRefused(const std::vector<Case>& cases);

inline constexpr const char* kConfig = "firmware_app/config/adult.toml";
inline constexpr const char* kModel = "firmware_app/config/models/adult.toml";
inline constexpr const char* kRigModel = "firmware_app/config/models/adult_rubbing.toml";
inline constexpr const char* kMap = "firmware_app/config/can/patella.toml";
inline constexpr const char* kDbc = "drivers/can/patella.dbc";

}  // namespace patella::test
