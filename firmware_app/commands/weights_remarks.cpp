#include "firmware_app/commands/weights_remarks.hpp"

#include "firmware_app/files/atomic_file.hpp"

namespace patella::app {

std::vector<std::string> weightsRemarks(const RunConfig& config) {
  std::vector<std::string> remarks;
  if (!config.weights) {
    return remarks;
  }
  const std::string file = config.weights_path.string();
  if (!config.weights_origin.sealed) {
    remarks.push_back(unsealedWarning(config.weights_path));
  }
  // A correction is of what one model leaves over: beside another it may add error.
  const std::string& trained = config.weights_origin.model_sha256;
  if (const std::string model = trained.empty() ? "" : fileSha256(config.model_path); model != trained) {
    remarks.push_back(file + ": trained with another model, SHA-256 " + trained + ", than " +
                      config.model_path.string() + ", SHA-256 " + model +
                      "; expected weights that were trained with this one, or no 'weights'");
  }
  // Compensation acts on the network's own inputs, and a linear path takes up what its recordings do not
  // show (docs/training.md, Linear path).
  if (!config.weights->linear_lags.empty() && config.tick.gains.compensation > 0.0 &&
      config.tick.compensation == tick::CompensationSource::kNetwork) {
    remarks.push_back(file +
                      ": a network with a linear path compensates here; train it on a recording in which one "
                      "did, or with --linear-lags none");
  }
  return remarks;
}

}  // namespace patella::app
