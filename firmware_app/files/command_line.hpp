// What a program says of arguments that it cannot take: argument, value, and what was expected. For programs
// that parse with CLI11.
#pragma once

#include <iostream>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>

#include "firmware_app/files/wording.hpp"

namespace patella::app {

/// Options of the program, and of the command that was asked for.
inline std::vector<const CLI::Option*> optionsInUse(const CLI::App& app) {
  std::vector<const CLI::Option*> options = app.get_options();
  for (const CLI::App* command : app.get_subcommands()) {
    const std::vector<const CLI::Option*> more = optionsInUse(*command);
    options.insert(options.end(), more.begin(), more.end());
  }
  return options;
}

inline std::string expectedWords(const std::string& type) {
  if (type.starts_with("FLOAT")) {
    return "a number";
  }
  return type.starts_with("UINT")  ? "a whole number from 0"
         : type.starts_with("INT") ? "a whole number"
                                   : type;
}

/// In place of the parser's "Could not convert: --duration = abc"; empty where that was not the trouble.
inline std::string conversionWords(const CLI::App& app, std::string_view said) {
  for (const CLI::Option* option : optionsInUse(app)) {
    const std::string start = "Could not convert: " + option->get_name() + " = ";
    if (said.starts_with(start)) {
      return option->get_name() + ": value '" + std::string(said.substr(start.size())) + "', expected " +
             expectedWords(option->get_type_name());
    }
  }
  return {};
}

/// An option that there is not, which the parser tells of only where all that are required are there.
inline std::string unknownOptionWords(const CLI::App& app) {
  std::vector<std::string> known;
  for (const CLI::Option* option : optionsInUse(app)) {
    for (const std::string& name : option->get_lnames()) {
      known.push_back("--" + name);
    }
  }
  for (const std::string& left : app.remaining(true)) {
    if (left.starts_with("-")) {
      return left + ": unknown option, expected one that --help names" + suggestion(left, known);
    }
  }
  return {};
}

/// Says what is wrong, or what was asked for. Returns the exit status: 0 after help or a version, else 1, as
/// the parser's own numbers are not promised.
inline int exitAfterParsing(const CLI::App& app, const CLI::ParseError& error) {
  std::string words;
  if (error.get_name() == "ConversionError") {
    words = conversionWords(app, error.what());
  } else if (error.get_name() == "RequiredError" || error.get_name() == "ExtrasError") {
    words = unknownOptionWords(app);
  }
  if (words.empty()) {
    return app.exit(error) == 0 ? 0 : 1;
  }
  std::cerr << words << "\nRun with --help for more information.\n";
  return 1;
}

}  // namespace patella::app
