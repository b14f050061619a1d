// The frame of a command-line program: arguments, work, and what to say where either is wrong.
#pragma once

#include <charconv>
#include <cstdint>
#include <exception>
#include <functional>
#include <iostream>
#include <string>
#include <system_error>

#include <CLI/CLI.hpp>

#include "drivers/files/interruption.hpp"
#include "firmware_app/files/command_line.hpp"

namespace patella::options {

/// The parser takes -1 for the largest number without a sign, and what is larger than that for it, too.
inline void refuseNegative(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    if (option->get_type_name() == "UINT") {
      option->check(CLI::Validator(
          [](std::string& text) {
            std::uint64_t value = 0;
            const char* const end = text.data() + text.size();
            const auto [stopped, error] = std::from_chars(text.data(), end, value);
            return error == std::errc() && stopped == end
                       ? std::string()
                       : "value '" + text + "', expected a whole number from 0";
          },
          ""));
    }
  }
  for (CLI::App* command : app.get_subcommands({})) {
    refuseNegative(*command);
  }
}

/// Parses the arguments, then runs the program. Returns the exit status: 0 after the work, help or a version;
/// 1 after an error, which is said on stderr behind the program's name. Interrupted, it leaves nothing behind
/// that nobody keeps.
inline int runProgram(CLI::App& app, int argc, char** argv, const std::function<void()>& work) {
  refuseNegative(app);
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
