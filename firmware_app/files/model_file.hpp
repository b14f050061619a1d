// model.toml: the mechanism, its nominal parameters and the effects that diagnosis or a user has added.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/model_description.hpp"
#include "firmware_app/files/file_error.hpp"

namespace patella::app {

/// Reads and checks a model file. Throws FileError "file:line: key 'effect[2].joint': value 3, expected ...",
/// also for unknown keys, kinds and parameters. Two links may be given by `base_parameters`, see
/// base_parameters.hpp; they are then written with masses and centres of mass. A chain may be that of a URDF,
/// see chain_table.hpp; it is then written link by link.
/// `urdfs`, where given, becomes those that the file names.
model::ModelDescription loadModel(const std::filesystem::path& path,
                                  std::vector<std::filesystem::path>* urdfs = nullptr);
/// `name` stands for the file in messages.
model::ModelDescription parseModel(std::string_view text, const std::string& name,
                                   std::vector<std::filesystem::path>* urdfs = nullptr);

/// The text of a model file with meaning and range of every number as comments; `heading` becomes comment
/// lines at the top. parseModel() gives back the same numbers to the bit.
std::string modelText(const model::ModelDescription& description, std::string_view heading = {});
/// Checks by makeModel(), then writes atomically. Throws FileError or std::invalid_argument.
void saveModel(const model::ModelDescription& description, const std::filesystem::path& path,
               std::string_view heading = {});

}  // namespace patella::app
