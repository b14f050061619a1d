// Torque of a body of the benchmark along a motion.
#pragma once

#include <optional>

#include "tools/bench/diagnose/plant.hpp"

namespace patella::bench {

class InverseDynamics {
 public:
  explicit InverseDynamics(const Body& body);

  /// Damping included: N·m in the joints.
  PerJoint operator()(const PerJoint& q, const PerJoint& dq, const PerJoint& ddq);

 private:
  Body body_;
  std::optional<ChainBody> chain_;
};

/// The same body where nothing falls.
Body weightless(Body body);

}  // namespace patella::bench
