// model.toml: the mechanism, its nominal parameters and the effects that diagnosis or a user has added.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/model/dynamics_model.hpp"
#include "core/model/one_dof.hpp"
#include "core/model/planar_two_link.hpp"
#include "firmware_app/files/file_error.hpp"

namespace patella::app {

struct EffectDescription {
  std::string kind;
  int joint = 0;                   ///< from 0; files count from 1
  std::vector<double> parameters;  ///< in the order of the kind's descriptor
};

using MechanismDescription = std::variant<model::PlanarTwoLinkParameters, model::RevoluteJointParameters,
                                          model::PrismaticJointParameters>;

/// What a model file says, as plain data that can be changed and written again.
struct ModelDescription {
  MechanismDescription mechanism;
  std::vector<EffectDescription> effects;

  int joints() const noexcept;
};

/// Reads and checks a model file. Throws FileError "file:line: key 'effect[2].joint': value 3, expected ...",
/// also for unknown keys, kinds and parameters. Two links may be given by `base_parameters`, see
/// base_parameters.hpp; they are then written with masses and centres of mass.
ModelDescription loadModel(const std::filesystem::path& path);
/// `name` stands for the file in messages.
ModelDescription parseModel(std::string_view text, const std::string& name);

/// Throws std::invalid_argument when a value is out of its range.
model::DynamicsModel makeModel(const ModelDescription& description);
/// What makeModel() was given. Throws std::invalid_argument for a mechanism that no file can describe.
ModelDescription describeModel(const model::DynamicsModel& dynamics);

/// The text of a model file with meaning and range of every number as comments; `heading` becomes comment
/// lines at the top. parseModel() gives back the same numbers to the bit.
std::string modelText(const ModelDescription& description, std::string_view heading = {});
/// Checks by makeModel(), then writes atomically. Throws FileError or std::invalid_argument.
void saveModel(const ModelDescription& description, const std::filesystem::path& path,
               std::string_view heading = {});

}  // namespace patella::app
