#include "firmware_app/commands/bounds_command.hpp"

#include <array>
#include <string_view>

#include "core/bounds/bounds.hpp"
#include "core/model/effect.hpp"
#include "firmware_app/files/wording.hpp"

namespace patella::app {
namespace {

constexpr std::string_view kPreface =
    R"(# What every number may be

This is what `patella bounds` prints: the tables in `core/bounds`, which loading and construction check against, and the
ranges of the effects' parameters. A number outside of its range is refused at the start, with file, line, key, value and
range. Ends belong to the range; no number may be NaN or infinite. Relations between numbers are named in the last column.

Where two numbers stand under *to*, the second one holds with `loop.rehearsal = true`: for hosts that cannot keep a rig's
time, such as an emulated board. A rehearsal moves no motor: it is refused on a CAN interface that is not virtual (vcan).
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

std::string cells(const Bound& row) {
  const std::string magnitude = row.of_magnitude ? "±" : "";
  const std::string rehearsed =
      row.rehearsal_maximum != row.maximum ? "; " + formatNumber(row.rehearsal_maximum) : "";
  return "| `" + std::string(row.name) + "` | " + std::string(row.unit) + " | " + magnitude +
         formatNumber(row.minimum) + " | " + magnitude + formatNumber(row.maximum) + rehearsed + " | " +
         std::string(row.reason) + " |\n";
}

std::string effectRows() {
  std::string text =
      "\n## Model: effects\n\nAn effect's range is wide where it serves linear axes too (N, N·s/m), and is "
      "what "
      "`patella-diagnose` searches.\n\n| kind | parameter | from | to | what it is "
      "|\n|---|---|---|---|---|\n";
  for (const model::EffectDescriptor* effect : model::effectCatalogue()) {
    for (const model::EffectParameter& parameter : effect->parameters) {
      text += "| `" + std::string(effect->kind) + "` | `" + std::string(parameter.name) + "` | " +
              formatNumber(parameter.minimum) + " | " + formatNumber(parameter.maximum) + " | " +
              std::string(parameter.meaning) + " |\n";
    }
  }
  return text;
}

}  // namespace

std::string boundsDocument() {
  std::string text(kPreface);
  for (const BoundGroup& group : kBoundGroups) {
    text +=
        "\n## " + std::string(group.title) + "\n\n| key | unit | from | to | why |\n|---|---|---|---|---|\n";
    for (const Bound& row : group.rows) {
      text += cells(row);
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
