#include "tools/recordings/signal_source.hpp"

#include <algorithm>
#include <initializer_list>

namespace patella::diagnose {
namespace {

using app::FileError;
using app::TomlTable;

constexpr const char* kTorqueConstant = "torque_constant_Nm_A";
constexpr std::int64_t kMostColumns = 1'000'000;

double readFactor(const TomlTable& table, const char* key) {
  const double factor = table.number(key, app::kAnyNumber, 1.0);
  if (factor == 0.0) {
    throw table.error(key, "value 0, expected a number other than 0");
  }
  return factor;
}

/// Torque at the joint per unit of the column.
double readTorqueConstant(const TomlTable& table) {
  if (table.has(kTorqueConstant)) {
    return table.number(kTorqueConstant, app::kPositive) * readFactor(table, "gear");
  }
  if (table.has("gear")) {
    throw table.error("gear", std::string("stands without '") + kTorqueConstant +
                                  "', expected both for a current, or 'scale' for a torque");
  }
  return 1.0;
}

SignalTerm readTerm(const TomlTable& table, Quantity quantity, ColumnNaming naming) {
  SignalTerm term{.column = readColumn(table, naming), .scale = readFactor(table, "scale")};
  if (quantity == Quantity::kTorque) {
    term.scale *= readTorqueConstant(table);
  }
  return term;
}

std::vector<SignalTerm> readTerms(const TomlTable& table, Quantity quantity, ColumnNaming naming) {
  if (!table.has("sum")) {
    return {readTerm(table, quantity, naming)};
  }
  std::vector<SignalTerm> terms;
  for (const TomlTable& part : table.tables("sum")) {
    terms.push_back(readTerm(part, quantity, naming));
  }
  if (terms.empty()) {
    throw table.error("sum", "0 columns, expected at least one");
  }
  return terms;
}

void requireOneOf(const TomlTable& table, std::initializer_list<const char*> keys) {
  const char* first = nullptr;
  for (const char* key : keys) {
    if (table.has(key) && first != nullptr) {
      throw table.error(key, std::string("stands beside '") + first + "', expected one of the two");
    }
    first = table.has(key) ? key : first;
  }
}

void requireNoUnitOfCurrents(const TomlTable& table) {
  if (!table.has("unit")) {
    return;
  }
  const std::vector<TomlTable> parts = table.has("sum") ? table.tables("sum") : std::vector{table};
  if (std::any_of(parts.begin(), parts.end(), [](const TomlTable& p) { return p.has(kTorqueConstant); })) {
    throw table.error("unit", std::string("stands beside '") + kTorqueConstant +
                                  "', which gives N·m of A; expected 'scale' for a current in another unit");
  }
}

}  // namespace

std::string FileColumn::text() const {
  return index == 0 ? name : name + "(:," + std::to_string(index) + ")";
}

FileColumn readColumn(const TomlTable& table, ColumnNaming naming, const std::string& prefix) {
  const std::string key = prefix + "column";
  const std::string index = prefix + "index";
  const bool numbered = naming == ColumnNaming::kNumbers;
  FileColumn column;
  try {
    column.name = numbered ? std::to_string(table.integer(key, 1, kMostColumns)) : table.string(key);
  } catch (const FileError& error) {
    throw FileError(std::string(error.what()) + (numbered ? "; columns have numbers where header = false"
                                                 : table.has(key)
                                                     ? "; columns have names unless header = false"
                                                     : ""));
  }
  if (table.has(index)) {
    column.index = static_cast<std::size_t>(table.integer(index, 1, kMostColumns));
  }
  return column;
}

double readUnit(const TomlTable& table, Quantity quantity, const char* key) {
  const std::span<const Unit> units = unitsOf(quantity);
  std::vector<std::string> names;
  for (const Unit& unit : units) {
    names.emplace_back(unit.name);
  }
  const std::string name = table.choice(key, names, names.front());
  return std::find_if(units.begin(), units.end(), [&](const Unit& unit) { return unit.name == name; })
      ->factor;
}

SignalSource readSignal(const TomlTable& table, Quantity quantity, ColumnNaming naming) {
  requireOneOf(table, {"column", "sum"});
  const double unit = readUnit(table, quantity);
  requireNoUnitOfCurrents(table);
  SignalSource source{.terms = readTerms(table, quantity, naming),
                      .offset = unit * table.number("offset", app::kAnyNumber, 0.0)};
  for (SignalTerm& term : source.terms) {
    term.scale *= unit;
  }
  return source;
}

SignalSource readSignalOrConstant(const TomlTable& table, Quantity quantity, ColumnNaming naming) {
  requireOneOf(table, {"column", "sum", "constant"});
  if (!table.has("constant")) {
    return readSignal(table, quantity, naming);
  }
  return {.terms = {}, .offset = readUnit(table, quantity) * table.number("constant")};
}

}  // namespace patella::diagnose
