#include "tools/diagnose/output/revealed_json.hpp"

#include <string>

#include "core/model/effect.hpp"

namespace patella::diagnose {

nlohmann::ordered_json describeRevealed(const Revealed& revealed) {
  nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
  for (std::size_t p = 0; p < revealed.parameters.size(); ++p) {
    parameters[std::string(model::findEffect(revealed.kind)->parameters[p].name)] = revealed.parameters[p];
  }
  return {{"effect", revealed.kind},
          {"joint", revealed.joint + 1},
          {"parameter", revealed.parameter},
          {"smallest_size", revealed.smallest_size},
          {"parameters", parameters},
          {"torque_rms", revealed.torque_rms_Nm},
          {"share_of_torque", revealed.share_of_torque}};
}

}  // namespace patella::diagnose
