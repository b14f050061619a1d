// The shipped configuration with places of it changed, and what is said of it then.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <utility>

#include <doctest/doctest.h>

#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/checkout/checkout.hpp"

namespace patella::test {

inline const std::filesystem::path kShipped = checkout::source() / "firmware_app/config";

struct Change {
  std::string from, to;
};

/// The first place of it that there is; without one, the test case ends.
inline std::string changed(std::string text, const Change& change) {
  const std::size_t at = text.find(change.from);
  REQUIRE_MESSAGE(at != std::string::npos, "there is no '", change.from, "'");
  return text.replace(at, change.from.size(), change.to);
}

/// All places, of which there is at least one.
inline std::string changedEverywhere(std::string text, const Change& change) {
  REQUIRE_MESSAGE(text.find(change.from) != std::string::npos, "there is no '", change.from, "'");
  for (std::size_t at = 0; (at = text.find(change.from, at)) != std::string::npos; at += change.to.size()) {
    text.replace(at, change.from.size(), change.to);
  }
  return text;
}

/// A run configuration that may stand anywhere: what it names by the folder of the shipped ones is there.
inline std::string withShippedPaths(std::string text) {
  const std::string beside = (kShipped / "").string();
  for (const char* folder : {"\"can/", "\"models/", "\"weights/", "\"references/"}) {
    for (std::size_t at = 0; (at = text.find(folder, at)) != std::string::npos; at += beside.size()) {
      text.insert(at + 1, beside);
    }
  }
  return text;
}

/// adult.toml without its network, on a bus map that stands beside it as map.toml.
inline std::string adultBesideItsMap() {
  std::string text = changed(app::readFile(kShipped / "adult.toml"), {"\nweights = ", "\n# "});
  return withShippedPaths(changed(std::move(text), {"\"can/patella.toml\"", "\"map.toml\""}));
}

/// What is said of a run configuration beside map.toml; empty where it is sound.
inline std::string refusalOf(const std::string& run, const std::string& map,
                             std::optional<double> rate_Hz = {}) {
  const ScratchFolder folder;
  app::writeFile(folder / "run.toml", run);
  app::writeFile(folder / "map.toml", map);
  app::CommandLine line;
  line.config = folder / "run.toml";
  line.rate_Hz = rate_Hz;
  try {
    app::loadRunConfig(line);
  } catch (const app::FileError& error) {
    return error.what();
  }
  return "";
}

inline bool says(const std::string& text, const std::string& part) {
  CAPTURE(text);
  CAPTURE(part);
  return text.find(part) != std::string::npos;
}

}  // namespace patella::test
