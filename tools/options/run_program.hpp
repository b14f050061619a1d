// The frame of a command-line program: arguments, work, and what to say where either is wrong.
#pragma once

#include <exception>
#include <functional>
#include <iostream>

#include <CLI/CLI.hpp>

#include "drivers/files/interruption.hpp"
#include "firmware_app/files/command_line.hpp"

namespace patella::options {

/// Parses the arguments, then runs the program. Returns the exit status: 0 after the work, help or a version;
/// 1 after an error, which is said on stderr behind the program's name. Interrupted, it leaves nothing behind
/// that nobody keeps.
inline int runProgram(CLI::App& app, int argc, char** argv, const std::function<void()>& work) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return patella::app::exitAfterParsing(app, error);
  }
  try {
    const files::CleanEnd clean_end;
    work();
  } catch (const std::exception& error) {
    std::cerr << app.get_name() << ": " << error.what() << "\n";
    return 1;
  }
  return 0;
}

}  // namespace patella::options
