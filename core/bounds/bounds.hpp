// The ranges of all numbers that a person writes for loop and rig: the tables, and how rows are used.
#pragma once

#include <array>
#include <span>
#include <string_view>

#include "core/bounds/bound.hpp"
#include "core/bounds/bus_map.hpp"
#include "core/bounds/fault_script.hpp"
#include "core/bounds/model.hpp"
#include "core/bounds/run_configuration.hpp"
#include "core/bounds/weights.hpp"
#include "core/types.hpp"

namespace patella {

struct BoundGroup {
  std::string_view title;
  std::span<const Bound> rows;
};

inline constexpr std::array kBoundGroups{
    BoundGroup{"Run: loop, real time, bus, network, GPIO", bounds::kLoop},
    BoundGroup{"Run: estimation", bounds::kEstimation},
    BoundGroup{"Run: EMG", bounds::kEmg},
    BoundGroup{"Run: control and reference", bounds::kControl},
    BoundGroup{"Run: safety", bounds::kSafety},
    BoundGroup{"Run: simulated rig", bounds::kRig},
    BoundGroup{"Bus map", bounds::kBusMap},
    BoundGroup{"Model: mechanism", bounds::kModel},
    BoundGroup{"Script of faults", bounds::kFaultScript},
    BoundGroup{"Weights: metadata", bounds::kWeights},
};

/// The row of that name; a name that no table has does not compile.
consteval Bound boundOf(std::string_view name) {
  for (const BoundGroup& group : kBoundGroups) {
    for (const Bound& row : group.rows) {
      if (row.name == name) {
        return row;
      }
    }
  }
  throw "no table has this name";
}

/// Throws std::invalid_argument "<name> = <value>, expected <minimum> to <maximum>" outside of the row, as
/// far as a rehearsal goes; NaN is refused. `name` stands for the row's own, where an index says more.
void requireBound(const Bound& bound, double value, std::string_view name = {});
/// The same for each of several values, such as those of the joints; they are counted from 1.
void requireBound(const Bound& bound, std::span<const double> values);

}  // namespace patella
