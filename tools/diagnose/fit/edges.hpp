// Where a fit has come to the end of what physics allows.
#pragma once

#include <string>
#include <vector>

namespace patella::diagnose {

struct ModelFit;

/// A parameter at the edge of what physics allows, with the data pulling it beyond.
struct Edge {
  std::string label;   ///< of the term
  std::string reason;  ///< "sign: stribeck_level_Nm", "range: delay_s"
};

/// Those of the terms that the model did not declare.
std::vector<Edge> edgesOf(const ModelFit& fit);

}  // namespace patella::diagnose
