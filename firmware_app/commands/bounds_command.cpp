#include "firmware_app/commands/bounds_command.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <vector>

#include "core/bounds/bounds.hpp"
#include "core/model/effect.hpp"
#include "firmware_app/commands/key_reference.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

constexpr std::string_view kPreface =
    R"(# Configuration reference

This is what `patella bounds` prints: every key of the files of loop and rig. Names, units, ranges and reasons are the
tables in `core/bounds`, which loading and construction check against. Defaults are those of the loop itself.

A number outside of its range is refused at the start, with file, line, key, value and range. Ends belong to the range.
No number may be NaN or infinite. The last column names the reason of the range, and relations between numbers.

Where two numbers stand under *to*, the second one holds with `loop.rehearsal = true`. That is for hosts that cannot keep
a rig's time, such as an emulated board. A rehearsal moves no motor: it is refused on a CAN interface that is not virtual
(vcan).

A path is taken from the folder of the file that names it, or as it stands where it begins with a slash. One of the command
line is taken from the folder where the program is started.

Examples that hold most keys are `firmware_app/config/adult.toml` and the files that it names.
)";

struct Argument {
  std::string_view option;
  std::string_view row;
};

constexpr std::array kArguments{Argument{"patella run --rate", boundOf("loop.rate_Hz").name},
                                Argument{"patella run --duration", boundOf("loop.duration_s").name},
                                Argument{"patella run --cpus", boundOf("realtime.cpus").name},
                                Argument{"patella run --seed", boundOf("rig.seed").name},
                                Argument{"patella-rig --duration", boundOf("loop.duration_s").name},
                                Argument{"patella-rig --seed", boundOf("rig.seed").name}};

std::string cells(const Bound& row, const std::vector<KeyDescription>& keys) {
  const std::string magnitude = row.of_magnitude ? "±" : "";
  const std::string rehearsed =
      row.rehearsal_maximum != row.maximum ? "; " + formatNumber(row.rehearsal_maximum) : "";
  const auto key = std::find_if(keys.begin(), keys.end(),
                                [&](const KeyDescription& candidate) { return candidate.name == row.name; });
  const std::string told =
      key == keys.end() ? " |  | " : " | " + key->fallback + " | " + std::string(key->meaning) + " | ";
  return "| `" + std::string(row.name) + "` | " + std::string(row.unit) + " | " + magnitude +
         formatNumber(row.minimum) + " | " + magnitude + formatNumber(row.maximum) + rehearsed + told +
         std::string(row.reason) + " |\n";
}

std::string wordRows(std::string_view group) {
  std::string text;
  for (const WordKey& key : wordKeys()) {
    if (key.group == group) {
      text += "| `" + std::string(key.name) + "` | " + std::string(key.values) + " | " +
              std::string(key.fallback) + " | " + std::string(key.meaning) + " |\n";
    }
  }
  return text.empty() ? text : "| key | values | default | meaning |\n|---|---|---|---|\n" + text + "\n";
}

std::string effectRows() {
  std::string text =
      "\n## Model: effects\n\nAn effect's range is wide where it serves linear axes too (N, N·s/m). It is "
      "the range "
      "that `patella-diagnose` searches.\n\n| kind | parameter | from | to | default | meaning "
      "|\n|---|---|---|---|---|---|\n";
  for (const model::EffectDescriptor* effect : model::effectCatalogue()) {
    for (const model::EffectParameter& parameter : effect->parameters) {
      text += "| `" + std::string(effect->kind) + "` | `" + std::string(parameter.name) + "` | " +
              formatNumber(parameter.minimum) + " | " + formatNumber(parameter.maximum) + " | " +
              formatNumber(parameter.initial) + " | " + std::string(parameter.meaning) + " |\n";
    }
  }
  return text;
}

}  // namespace

std::string boundsDocument() {
  std::string text(kPreface);
  const std::vector<KeyDescription> keys = numberKeys();
  for (const BoundGroup& group : kBoundGroups) {
    text +=
        "\n## " + std::string(group.title) + "\n\n" + wordRows(group.title) +
        "| key | unit | from | to | default | meaning | why this range |\n|---|---|---|---|---|---|---|\n";
    for (const Bound& row : group.rows) {
      text += cells(row, keys);
    }
  }
  text += effectRows();
  text += "\n## Command line\n\n| option | as |\n|---|---|\n";
  for (const Argument& argument : kArguments) {
    text += "| `" + std::string(argument.option) + "` | `" + std::string(argument.row) + "` |\n";
  }
  return text;
}

}  // namespace patella::app
