// What each kind of carrier is loaded by.
#include <sstream>

#include <toml++/toml.h>

#include "firmware_app/configuration/bus_map_file.hpp"
#include "firmware_app/configuration/fault_script_file.hpp"
#include "firmware_app/configuration/run_config.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/files/model_file.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "firmware_app/weights/safetensors_file.hpp"
#include "tests/unit/configuration/bound_carriers.hpp"
#include "tests/unit/model/chains.hpp"
#include "tests/unit/network/random_network.hpp"

namespace patella::test {
namespace {

void loadWeights(const std::string& text, const std::filesystem::path& folder) {
  network::RandomNetworkOptions options;
  options.linear_lags = {0, 2};
  network::NetworkWeights weights = network::randomNetwork(options);
  for (std::size_t i = 0; i < weights.features.size(); ++i) {
    weights.features[i] = "feature" + std::to_string(i);
  }
  const std::filesystem::path path = folder / "net.safetensors";
  app::saveNetworkWeights(path, weights, {});
  app::Safetensors content = app::readSafetensors(path);
  const toml::table changes = toml::parse(text);
  for (const auto& [key, node] : changes) {
    std::ostringstream value;
    node.visit([&](const auto& of) { value << of; });
    // The first of several; the others stay.
    std::string& old = content.metadata[std::string(key.str())];
    const std::size_t comma = old.find(',');
    const bool last = key.str() == "linear_lags";
    old = last ? old.substr(0, old.rfind(',') + 1) + value.str()
               : value.str() + (comma == std::string::npos ? "" : old.substr(comma));
  }
  app::writeSafetensors(path, content);
  app::loadNetworkWeights(path);
}

}  // namespace

void load(FileKind kind, const std::string& text, const std::filesystem::path& folder) {
  const std::filesystem::path path = folder / "file.toml";
  switch (kind) {
    case FileKind::kRun: {
      app::writeFile(path, text);
      if (const auto model = folder / "eight_joints.toml"; !std::filesystem::exists(model)) {
        app::saveModel({.mechanism = RandomChains(1).draw(kMaxJoints), .effects = {}}, model);
      }
      app::CommandLine line;
      line.config = path;
      app::loadRunConfig(line);
      break;
    }
    case FileKind::kBusMap:
      app::parseBusDescription(text, "file.toml");
      break;
    case FileKind::kModel:
      app::parseModel(text, "file.toml");
      break;
    case FileKind::kFaultScript:
      app::writeFile(path, text);
      app::loadFaultScript(path, app::FaultStage::kInProcess, 2);
      break;
    case FileKind::kWeights:
      loadWeights(text, folder);
      break;
  }
}

}  // namespace patella::test
