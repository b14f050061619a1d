// Every row of core/bounds against the loader that reads its key: what lies outside is refused by name, what
// lies on an end is taken.
#include "core/bounds/bounds.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <set>
#include <sstream>
#include <stdexcept>

#include <doctest/doctest.h>
#include <toml++/toml.h>

#include "core/model/effect.hpp"
#include "firmware_app/commands/bounds_command.hpp"
#include "firmware_app/commands/key_reference.hpp"
#include "firmware_app/configuration/bus_map_file.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "firmware_app/files/wording.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tests/unit/configuration/bound_carriers.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;
using namespace patella::test;

namespace {

/// The table that holds the last key of `path`, such as "reference.joint.offset_rad"; the first one that does
/// where tables stand in an array. Null where there is none.
toml::table* holderOf(toml::node& at, std::string_view path) {
  if (toml::array* array = at.as_array()) {
    for (toml::node& element : *array) {
      if (toml::table* found = holderOf(element, path)) {
        return found;
      }
    }
    return nullptr;
  }
  toml::table* table = at.as_table();
  const std::size_t dot = path.find('.');
  toml::node* next = table == nullptr ? nullptr : table->get(path.substr(0, dot));
  if (next == nullptr || dot == std::string_view::npos) {
    return next == nullptr ? nullptr : table;
  }
  return holderOf(*next, path.substr(dot + 1));
}

/// Puts a number in its place, the first one in an array.
template <typename Number>
void assign(toml::table& table, std::string_view key, Number value) {
  if (toml::array* array = table.get_as<toml::array>(key)) {
    array->replace(array->cbegin(), value);
  } else {
    table.insert_or_assign(key, value);
  }
}

/// The table of `root`, a carrier's file, that holds the row's key; null where none does.
toml::table* holderOf(toml::table& root, const Bound& bound) {
  const std::size_t bracket = bound.name.find(" (");
  if (bracket != std::string_view::npos) {
    const std::string_view kind = bound.name.substr(bracket + 2, bound.name.size() - bracket - 3);
    if (root["mechanism"]["kind"].value_or(std::string_view()) != kind) {
      return nullptr;
    }
  }
  return holderOf(root, bound.name.substr(0, bracket));
}

/// What stands in a carrier, to be changed.
toml::table parsed(const Carrier& carrier) {
  static std::map<const Carrier*, toml::table> roots;
  const auto found = roots.find(&carrier);
  return found != roots.end() ? found->second
                              : roots.emplace(&carrier, toml::parse(carrier.text)).first->second;
}

/// The carrier's text with another value, or empty where it does not hold the row's key.
std::string changed(const Carrier& carrier, const Bound& bound, double value) {
  toml::table root = parsed(carrier);
  toml::table* holder = holderOf(root, bound);
  if (holder == nullptr) {
    return "";
  }
  if (bound.whole && std::isfinite(value)) {
    assign(*holder, bound.key(), static_cast<std::int64_t>(value));
  } else {
    assign(*holder, bound.key(), value);
  }
  std::ostringstream text;
  text << root;
  return text.str();
}

/// The carrier's text without the key, or empty where it does not hold it.
std::string without(const Carrier& carrier, const Bound& bound) {
  toml::table root = parsed(carrier);
  toml::table* holder = holderOf(root, bound);
  if (holder == nullptr) {
    return "";
  }
  holder->erase(bound.key());
  std::ostringstream text;
  text << root;
  return text.str();
}

std::string outcome(FileKind kind, const std::string& text, const std::filesystem::path& folder) {
  try {
    load(kind, text, folder);
    return "accepted";
  } catch (const std::exception& error) {
    return error.what();
  }
}

struct Found {
  FileKind kind;
  std::string text;
};

Found fileWith(const Bound& bound, double value) {
  for (const Carrier& carrier : carriers()) {
    if (const std::string text = changed(carrier, bound, value); !text.empty()) {
      return {carrier.kind, text};
    }
  }
  FAIL("no loader reads ", bound.name);
  return {};
}

std::string outcome(const Bound& bound, double value) {
  static const ScratchFolder folder;
  const Found file = fileWith(bound, value);
  return outcome(file.kind, file.text, folder.path());
}

std::string shown(const Bound& bound, double value) {
  return bound.whole && std::isfinite(value) ? std::to_string(static_cast<std::int64_t>(value))
                                             : app::formatNumber(value);
}

void checkRefused(const Bound& bound, double value) {
  const std::string message = outcome(bound, value);
  CAPTURE(bound.name);
  CAPTURE(value);
  CAPTURE(message);
  CHECK(message.find(std::string(bound.key())) != std::string::npos);
  CHECK(message.find(shown(bound, value)) != std::string::npos);
  CHECK(message.find("expected") != std::string::npos);
  CHECK(message.find(shown(bound, bound.maximum)) != std::string::npos);
}

double beyond(const Bound& bound, double end, double sign) {
  if (bound.whole) {
    return end + sign;
  }
  return end == 0.0 ? sign * 1e-3 : end + sign * 0.01 * std::abs(end);
}

/// Ends that another number of the carriers forbids, with what is said of it.
const std::multimap<std::string_view, std::pair<double, std::string>> kRelated = {
    {"loop.stall_tolerated_s", {0.001, "more than a tick"}},
    {"checks.encoder_timeout_s", {0.0005, "encoder_period_s"}},
    {"checks.emg_timeout_s", {0.0005, "emg_period_s"}},
    {"checks.encoder_period_s", {5e-5, "120 rad/s"}},
    {"checks.position_min_rad", {4.0 * std::numbers::pi, "less than position_max_rad"}},
    {"checks.position_max_rad", {-4.0 * std::numbers::pi, "less than position_max_rad"}},
    {"safety.q_min_rad", {2.0 * std::numbers::pi, "more than q_min_rad"}},
    {"safety.q_max_rad", {-2.0 * std::numbers::pi, "more than q_min_rad"}},
    {"canopen.master_node", {1, "a number of its own"}},
    {"cia402.node", {127, "no message with the identifier 1FFh"}},
    {"range.minimum", {1e6, "more than minimum"}},
    {"range.maximum", {-1e6, "more than minimum"}},
    {"estimation.velocity_cutoff_Hz", {5000, "half of the encoder's rate"}},
    {"estimation.estimate_cutoff_Hz", {5000, "half of the encoder's rate"}},
    {"estimation.bandwidth_Hz", {5000, "half of the encoder's rate"}},
    {"heads", {4096, "divisor"}},
    {"linear_lags", {0, "expected more"}},
    {"mechanism.base_parameters.thigh_inertia_kg_m2 (planar_two_link)", {1e-7, "fit no two links"}},
    {"mechanism.base_parameters.thigh_inertia_kg_m2 (planar_two_link)",
     {420, "inertia_kg_m2 (planar_two_link)[1] = "}},
    {"mechanism.base_parameters.shank_inertia_kg_m2 (planar_two_link)", {1e-7, "fit no two links"}},
    {"mechanism.base_parameters.shank_inertia_kg_m2 (planar_two_link)",
     {220, "inertia_kg_m2 (planar_two_link)[2] = "}},
    {"mechanism.base_parameters.thigh_moment_kg_m (planar_two_link)", {0, "fit no two links"}},
    {"mechanism.base_parameters.thigh_moment_kg_m (planar_two_link)",
     {200, "mass_kg (planar_two_link)[1] = "}},
    {"mechanism.base_parameters.shank_moment_kg_m (planar_two_link)", {100, "fit no two links"}},
    {"mechanism.link.mass_kg (serial_chain)", {0, "more than 0 with an inertia"}},
    {"mechanism.link.inertia_kg_m2 (serial_chain)", {-1000, "none below 0"}},
    {"mechanism.link.inertia_kg_m2 (serial_chain)", {1000, "at most the sum of the other two"}},
};

}  // namespace

TEST_CASE("the files that carry the numbers are sound, so that every refusal below is owed to one number") {
  const ScratchFolder folder;
  for (const Carrier& carrier : carriers()) {
    CAPTURE(carrier.text);
    CHECK_NOTHROW(load(carrier.kind, carrier.text, folder.path()));
  }
}

TEST_CASE("every row is read by a loader, which refuses what lies outside by key, value and range") {
  for (const BoundGroup& group : kBoundGroups) {
    for (const Bound& bound : group.rows) {
      checkRefused(bound, beyond(bound, bound.maximum, 1.0));
      if (bound.of_magnitude) {
        checkRefused(bound, -beyond(bound, bound.maximum, 1.0));
        checkRefused(bound, 0.5 * bound.minimum);
        checkRefused(bound, -0.5 * bound.minimum);
        checkRefused(bound, 0.0);
      } else {
        checkRefused(bound, beyond(bound, bound.minimum, -1.0));
      }
      for (const double none :
           {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(),
            -std::numeric_limits<double>::infinity()}) {
        const std::string message = outcome(bound, none);
        CAPTURE(bound.name);
        CAPTURE(message);
        CHECK(message != "accepted");
        CHECK(message.find(std::string(bound.key())) != std::string::npos);
      }
    }
  }
}

TEST_CASE("the ends of every row are taken, but where another number forbids it") {
  for (const BoundGroup& group : kBoundGroups) {
    for (const Bound& bound : group.rows) {
      for (const double end : {bound.minimum, bound.maximum}) {
        const std::string message = outcome(bound, end);
        CAPTURE(bound.name);
        CAPTURE(end);
        const auto [first, last] = kRelated.equal_range(bound.name);
        const auto related =
            std::find_if(first, last, [=](const auto& row) { return row.second.first == end; });
        if (related != last) {
          CAPTURE(message);
          CHECK(message.find(related->second.second) != std::string::npos);
        } else {
          CHECK(message == "accepted");
        }
      }
    }
  }
}

TEST_CASE("a row has a name of its own, a reason, and a range with room in it") {
  std::set<std::string_view> names;
  for (const BoundGroup& group : kBoundGroups) {
    for (const Bound& bound : group.rows) {
      CAPTURE(bound.name);
      CHECK(names.insert(bound.name).second);
      CHECK(bound.reason.size() >= 4);
      CHECK(std::isfinite(bound.minimum));
      CHECK(std::isfinite(bound.maximum));
      CHECK(bound.minimum < bound.maximum);
      CHECK(bound.rehearsal_maximum >= bound.maximum);
      CHECK((!bound.whole || bound.maximum == std::floor(bound.maximum)));
    }
  }
}

TEST_CASE("every parameter of every effect is refused outside of its range, and taken at its ends") {
  const std::string leg =
      "[mechanism]\nkind = \"planar_two_link\"\nmass_kg = [7.2, 4.4]\nlength_m = [0.4, 0.4]\n"
      "com_m = [0.17, 0.24]\ninertia_kg_m2 = [0.12, 0.12]\n";
  const auto outcomeOf = [&](const model::EffectDescriptor& effect, std::size_t index, double value) {
    std::ostringstream text;
    text << leg << "[[effect]]\nkind = \"" << effect.kind << "\"\njoint = 2\n";
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      text << effect.parameters[i].name << " = "
           << toml::value<double>(i == index ? value : effect.parameters[i].initial) << "\n";
    }
    try {
      app::parseModel(text.str(), "model.toml");
      return std::string("accepted");
    } catch (const std::exception& error) {
      return std::string(error.what());
    }
  };
  for (const model::EffectDescriptor* effect : model::effectCatalogue()) {
    for (std::size_t i = 0; i < effect->parameters.size(); ++i) {
      const model::EffectParameter& parameter = effect->parameters[i];
      CAPTURE(effect->kind);
      CAPTURE(parameter.name);
      const double room = 0.01 * (parameter.maximum - parameter.minimum);
      CHECK(std::isfinite(room));
      for (const double value :
           {parameter.minimum - room, parameter.maximum + room, std::numeric_limits<double>::quiet_NaN(),
            std::numeric_limits<double>::infinity()}) {
        const std::string message = outcomeOf(*effect, i, value);
        CAPTURE(message);
        CHECK(message.find("effect[1]." + std::string(parameter.name)) != std::string::npos);
        CHECK(message.find("value " + app::formatNumber(value)) != std::string::npos);
        CHECK(message.find(app::formatNumber(parameter.maximum)) != std::string::npos);
      }
      CHECK(outcomeOf(*effect, i, parameter.minimum) == "accepted");
      CHECK(outcomeOf(*effect, i, parameter.maximum) == "accepted");
    }
  }
}

TEST_CASE("a rehearsal may wait longer, and not for ever") {
  const ScratchFolder folder;
  int rows = 0;
  for (const BoundGroup& group : kBoundGroups) {
    for (const Bound& bound : group.rows) {
      if (bound.rehearsal_maximum == bound.maximum) {
        continue;
      }
      ++rows;
      CAPTURE(bound.name);
      const auto rehearse = [&](double value) {
        Found file = fileWith(bound, value);
        if (file.kind == FileKind::kBusMap) {
          app::parseBusDescription(file.text, "map.toml", {}, true);
          return;
        }
        REQUIRE(file.kind == FileKind::kRun);
        const std::string off = "rehearsal = false";
        file.text.replace(file.text.find(off), off.size(), "rehearsal = true");
        load(file.kind, file.text, folder.path());
      };
      CHECK_NOTHROW(rehearse(bound.rehearsal_maximum));
      CHECK_THROWS_AS(rehearse(beyond(bound, bound.rehearsal_maximum, 1.0)), app::FileError);
    }
  }
  CHECK(rows == 13);
}

TEST_CASE("a run shorter than a tick is no run without an end") {
  CHECK(outcome(boundOf("loop.duration_s"), 4e-4)
            .find("loop.duration_s': value 4e-04, expected at least a tick") != std::string::npos);
  CHECK(outcome(boundOf("loop.duration_s"), 1e-3) == "accepted");
}

TEST_CASE("an estimate has no low-pass, or one that is no slower than that of the velocity") {
  const Bound& bound = boundOf("estimation.estimate_cutoff_Hz");
  CHECK(outcome(bound, 0.0) == "accepted");
  CHECK(outcome(bound, 0.1) == "accepted");
  CHECK(
      outcome(bound, 0.05)
          .find(
              "estimation.estimate_cutoff_Hz': value 0.05, expected 0, which is without, or at least 0.1") !=
      std::string::npos);
}

TEST_CASE("a bus map that says nothing of positions bounds them all the same") {
  const std::string text = "dbc = \"" + checkout::source().string() +
                           "/drivers/can/patella.dbc\"\n[command]\nmessage = \"TorqueCommand\"\n";
  const can::BusMap map = app::parseBusDescription(text, "map.toml").map;
  CHECK(map.position_min_rad == boundOf("checks.position_min_rad").minimum);
  CHECK(map.position_max_rad == boundOf("checks.position_max_rad").maximum);
  CHECK(map.position_jump_rad == doctest::Approx(0.12));  // 120 rad/s over 1 ms
}

TEST_CASE(
    "every number has a meaning and a default in the reference, and a default means that the key may be left "
    "out") {
  static const ScratchFolder folder;
  std::map<std::string_view, app::KeyDescription> described;
  for (const app::KeyDescription& key : app::numberKeys()) {
    CHECK(described.emplace(key.name, key).second);
  }
  for (const BoundGroup& group : kBoundGroups) {
    for (const Bound& bound : group.rows) {
      CAPTURE(bound.name);
      REQUIRE(described.contains(bound.name));
      CHECK_FALSE(described.at(bound.name).meaning.empty());
      if (group.title == "Weights: metadata") {
        continue;  // the carrier's other metadata stand in; unit_weights has what is missing
      }
      const bool required = described.at(bound.name).fallback.find("required") != std::string::npos;
      bool refused = false;
      for (const Carrier& carrier : carriers()) {
        if (const std::string text = without(carrier, bound); !text.empty()) {
          const std::string message = outcome(carrier.kind, text, folder.path());
          refused = refused || message.find(bound.key()) != std::string::npos;
        }
      }
      CHECK(refused == required);
    }
  }
}

TEST_CASE("the document is what patella bounds prints") {
  const auto path = checkout::source() / "docs/configuration.md";
  CHECK_MESSAGE(app::readFile(path) == app::boundsDocument(),
                "docs/configuration.md is out of date: patella bounds > docs/configuration.md");
}
