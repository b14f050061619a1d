// A network that PyTorch has made, by the script of the documentation, in the loop's kernel.
#include <cmath>
#include <cstdlib>

#include <doctest/doctest.h>

#include "core/network/attention_lstm.hpp"
#include "firmware_app/files/csv_table.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "tests/support/scratch_folder.hpp"
#include "tools/checkout/checkout.hpp"

using namespace patella;

TEST_CASE("the documentation's script saves what the loop loads, and both say the same") {
  const test::ScratchFolder folder;
  const std::string project = checkout::source();
  const std::string command = "/usr/bin/python3 '" + project + "/tests/integration/pytorch/reference.py' '" +
                              project + "/docs/network.md' '" + folder.path().string() + "'";
  REQUIRE(std::system(command.c_str()) == 0);  // NOLINT(concurrency-mt-unsafe)
  app::WeightsOrigin origin;
  const network::NetworkWeights weights = app::loadNetworkWeights(folder / "weights.safetensors", &origin);
  CHECK(origin.sealed);
  network::AttentionLstm network(weights);
  const app::CsvTable table = app::CsvTable::load(folder / "reference.csv");
  REQUIRE(table.rows() == 2000);
  double largest = 0.0;
  double difference = 0.0;
  std::vector<double> features(weights.features.size());
  for (std::size_t step = 0; step < table.rows(); ++step) {
    for (std::size_t i = 0; i < features.size(); ++i) {
      features[i] = table.column("x" + std::to_string(i))[step];
    }
    const JointVector output = network.step(features);
    network.prepare();
    for (int joint = 0; joint < network.outputs(); ++joint) {
      const double expected = table.column("y" + std::to_string(joint))[step];
      largest = std::max(largest, std::abs(expected));
      difference = std::max(difference, std::abs(output[joint] - expected));
    }
  }
  MESSAGE("largest output " << largest << ", largest difference " << difference);
  CHECK(difference < 1e-6);
  CHECK(largest > 0.02);
}
