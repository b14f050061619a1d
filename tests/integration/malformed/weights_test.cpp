// Network weights with one defect each.
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include <doctest/doctest.h>

#include "core/network/network_weights.hpp"
#include "firmware_app/files/atomic_file.hpp"
#include "firmware_app/weights/network_weights_file.hpp"
#include "firmware_app/weights/safetensors_file.hpp"
#include "tests/integration/malformed/patella_process.hpp"

using namespace patella::test;

namespace {

using patella::network::NetworkShape;
using patella::network::NetworkWeights;

constexpr const char* kWeights = "tiny.safetensors";
constexpr const char* kShipped = "firmware_app/config/weights/demonstration.safetensors";

NetworkWeights tinyNetwork(std::vector<std::string> features, int outputs) {
  NetworkWeights weights;
  weights.lstm.resize(1);
  weights.heads = 1;
  weights.window = 4;
  weights.features = std::move(features);
  const auto inputs = static_cast<Eigen::Index>(weights.features.size());
  weights.feature_mean = Eigen::VectorXd::Zero(inputs);
  weights.feature_scale = Eigen::VectorXd::Ones(inputs);
  weights.output_mean = Eigen::VectorXd::Zero(outputs);
  weights.output_scale = Eigen::VectorXd::Ones(outputs);
  visitTensors(weights,
               NetworkShape{.inputs = inputs, .hidden = 4, .layers = 1, .channels = 4, .outputs = outputs},
               [](const std::string&, auto& tensor, Eigen::Index rows, Eigen::Index cols) {
                 tensor = std::decay_t<decltype(tensor)>::Constant(rows, cols, 0.25F);
               });
  return weights;
}

void save(Workshop& workshop, const NetworkWeights& weights) {
  patella::app::saveNetworkWeights(workshop.file(kWeights), weights);
}

// A sound network that the loop takes, then one thing changed in the file's bytes.
Damage bytesChanged(std::function<void(std::string&)> change) {
  return [=](Workshop& workshop) {
    save(workshop, tinyNetwork({"q1_rad", "q2_rad"}, 2));
    std::string bytes = workshop.read(kWeights);
    change(bytes);
    workshop.write(kWeights, bytes);
  };
}

// Likewise in its tensors and metadata.
Damage contentChanged(std::function<void(patella::app::Safetensors&)> change) {
  return [=](Workshop& workshop) {
    save(workshop, tinyNetwork({"q1_rad", "q2_rad"}, 2));
    patella::app::Safetensors content = patella::app::readSafetensors(workshop.file(kWeights));
    change(content);
    patella::app::writeSafetensors(workshop.file(kWeights), content);
  };
}

Damage network(NetworkWeights weights) {
  return [=](Workshop& workshop) { save(workshop, weights); };
}

void setHeaderLength(std::string& bytes, std::uint64_t length) {
  std::memcpy(bytes.data(), &length, sizeof(length));
}

const std::vector<std::string> kUseThem = {"--weights", "{dir}tiny.safetensors"};

}  // namespace

TEST_CASE("the tiny network is sound, so that every refusal below is owed to its defect") {
  Workshop workshop;
  save(workshop, tinyNetwork({"q1_rad", "q2_rad"}, 2));
  const Outcome outcome = workshop.patella(
      {"run", "--clock", "virtual", "--duration", "0.1", "--config", workshop.file(kConfig).string(), "--out",
       workshop.output().string(), "--weights", workshop.file(kWeights).string()});
  INFO(outcome.errors);
  CHECK(outcome.exit_status == 0);
  CHECK(outcome.errors.empty());
  CHECK(workshop.read("out/summary.json").find("\"digest\": \"right\"") != std::string::npos);
}

TEST_CASE("weights that are no safetensors file") {
  expectRefused({
      {"missing", none(), {"tiny.safetensors: "}, kUseThem},
      {"folder",
       turnedIntoFolder(kWeights),
       {"tiny.safetensors: is a directory, expected a regular file"},
       kUseThem},
      {"empty", written(kWeights, ""), {"tiny.safetensors: is 0 bytes long"}, kUseThem},
      {"truncated",
       bytesChanged([](std::string& bytes) { bytes.resize(bytes.size() - 10); }),
       {"tiny.safetensors: tensor '", "data_offsets", "not within"},
       kUseThem},
      {"truncated in the header",
       bytesChanged([](std::string& bytes) { bytes.resize(100); }),
       {"tiny.safetensors: is no safetensors file, or its end is missing: header length ",
        "expected at most 92"},
       kUseThem},
      {"header of 2^63 bytes",
       bytesChanged([](std::string& bytes) { setHeaderLength(bytes, std::uint64_t{1} << 63U); }),
       {"tiny.safetensors: is no safetensors file, or its end is missing: header length 9223372036854775808, "
        "expected at most"},
       kUseThem},
      {"header of no bytes",
       bytesChanged([](std::string& bytes) { setHeaderLength(bytes, 0); }),
       {"tiny.safetensors: header is not valid JSON"},
       kUseThem},
      {"one bit flipped",
       bytesChanged([](std::string& bytes) { bytes.back() = static_cast<char>(bytes.back() ^ 1); }),
       {"tiny.safetensors: is damaged: its digest (metadata 'seal_sha256') is ", "that of its content is"},
       kUseThem},
      {"bytes after the last tensor",
       bytesChanged([](std::string& bytes) { bytes += "surplus!"; }),
       {"tiny.safetensors: the tensors cover"},
       kUseThem},
  });
}

TEST_CASE("the network of the default configuration, missing or damaged, is named") {
  expectRefused({
      {"missing",
       removed(kShipped),
       {"adult.toml:", ": key 'weights'", "there is no file", "demonstration.safetensors"},
       {}},
      {"cut off",
       [](Workshop& workshop) { workshop.write(kShipped, workshop.read(kShipped).substr(0, 20'000)); },
       {"demonstration.safetensors: tensor '", "data_offsets", "not within"},
       {}},
      {"one bit flipped",
       [](Workshop& workshop) {
         std::string bytes = workshop.read(kShipped);
         bytes.back() = static_cast<char>(bytes.back() ^ 1);
         workshop.write(kShipped, bytes);
       },
       {"demonstration.safetensors: is damaged: its digest"},
       {}},
  });
}

TEST_CASE("weights without a digest are used, and check, run and summary say what that means") {
  Workshop workshop;
  save(workshop, tinyNetwork({"q1_rad", "q2_rad"}, 2));
  std::string bytes = workshop.read(kWeights);
  for (std::size_t at = bytes.find("\"seal"); at != std::string::npos; at = bytes.find("\"seal"))
    bytes[at + 1] = 'x';
  workshop.write(kWeights, bytes);
  const std::vector<std::string> common = {"--config", workshop.file(kConfig).string(), "--weights",
                                           workshop.file(kWeights).string()};
  std::vector<std::string> check = {"check"};
  check.insert(check.end(), common.begin(), common.end());
  const Outcome checked = workshop.patella(check);
  CHECK(checked.exit_status == 0);
  CHECK(checked.output.find("tiny.safetensors: no digest: damaged weights cannot be told from good ones") !=
        std::string::npos);
  std::vector<std::string> run = {
      "run", "--clock", "virtual", "--duration", "0.1", "--out", workshop.output().string()};
  run.insert(run.end(), common.begin(), common.end());
  const Outcome ran = workshop.patella(run);
  CHECK(ran.exit_status == 0);
  CHECK(ran.output.find("tiny.safetensors: no digest") != std::string::npos);
  CHECK(ran.output.find("the weights have no digest") != std::string::npos);
  CHECK(workshop.read("out/summary.json").find("\"digest\": \"none\"") != std::string::npos);
}

TEST_CASE("weights that were trained with another model are used, and check and run name both digests") {
  Workshop workshop;
  const auto said = [&](std::vector<std::string> arguments) {
    const std::vector<std::string> common = {"--config", workshop.file(kConfig).string(), "--weights",
                                             workshop.file(kShipped).string()};
    arguments.insert(arguments.end(), common.begin(), common.end());
    const Outcome outcome = workshop.patella(arguments);
    CHECK(outcome.exit_status == 0);
    return outcome.output;
  };
  CHECK(said({"check"}).find("another model") == std::string::npos);
  const std::string trained = patella::app::fileSha256(workshop.file(kModel));
  workshop.write(kModel, workshop.read(kModel) + "# my leg\n");
  const std::string remark = "demonstration.safetensors: trained with another model, SHA-256 " + trained +
                             ", than " + workshop.file(kModel).string() + ", SHA-256 " +
                             patella::app::fileSha256(workshop.file(kModel));
  for (const std::vector<std::string>& command :
       {std::vector<std::string>{"check"},
        {"run", "--clock", "virtual", "--duration", "0.1", "--out", workshop.output().string()}}) {
    const std::string output = said(command);
    CAPTURE(output);
    CHECK(output.find(remark) != std::string::npos);
  }
}

TEST_CASE("weights of another network") {
  static constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  expectRefused({
      {"not a number",
       bytesChanged([](std::string& bytes) { std::memcpy(bytes.data() + bytes.size() - 4, &kNan, 4); }),
       {"tiny.safetensors: tensor '", "element ", "is not a finite float32"},
       kUseThem},
      {"tensor missing",
       contentChanged([](patella::app::Safetensors& content) { content.tensors.erase("fc.bias"); }),
       {"tiny.safetensors: tensor 'fc.bias'", "missing"},
       kUseThem},
      {"tensor of another shape",
       contentChanged([](patella::app::Safetensors& content) {
         content.tensors["fc.bias"] = {{5}, std::vector<float>(5)};
       }),
       {"tiny.safetensors: tensor 'fc.bias': shape [5], expected [4]"},
       kUseThem},
      {"tensor too many",
       contentChanged([](patella::app::Safetensors& content) {
         content.tensors["fc2.bias"] = {{1}, std::vector<float>(1)};
       }),
       {"tiny.safetensors: tensor 'fc2.bias'", "no such tensor expected"},
       kUseThem},
      {"metadata missing",
       contentChanged([](patella::app::Safetensors& content) { content.metadata.erase("rate_Hz"); }),
       {"tiny.safetensors: metadata 'rate_Hz': missing"},
       kUseThem},
      {"unknown kind of output",
       contentChanged([](patella::app::Safetensors& content) { content.metadata["output"] = "position"; }),
       {"tiny.safetensors: metadata 'output': 'position', expected acceleration_rad_s2 or"},
       kUseThem},
      {"scale of nothing",
       contentChanged([](patella::app::Safetensors& content) { content.metadata["feature_scale"] = "1,0"; }),
       {"tiny.safetensors: feature_scale[2] = 0", "expected 1e-09 to 1e+07"},
       kUseThem},
  });
}

TEST_CASE("a sound network that does not fit this loop") {
  NetworkWeights slow = tinyNetwork({"q1_rad", "q2_rad"}, 2);
  slow.rate_Hz = 700.0;
  expectRefused({
      {"unknown feature",
       network(tinyNetwork({"q1_rad", "knee_angle"}, 2)),
       {"tiny.safetensors: feature 'knee_angle' of the network is unknown", "q2_rad"},
       kUseThem},
      {"outputs of one joint",
       network(tinyNetwork({"q1_rad", "q2_rad"}, 1)),
       {"tiny.safetensors: the network has 1 outputs, expected 2"},
       kUseThem},
      {"trained at another rate",
       network(slow),
       {"tiny.safetensors: ", "rate_Hz", "700", "expected 1000"},
       kUseThem},
  });
}

TEST_CASE("a precision that the network does not bear, and an instruction set that there is not") {
  const Damage strict = replaced(kConfig, "[control]",
                                 "[network]\nprecision = \"int16\"\nint16_tolerance = 1e-12\n\n[control]");
  expectRefused({
      {"int16 beyond its tolerance",
       [=](Workshop& workshop) {
         save(workshop, tinyNetwork({"q1_rad", "q2_rad"}, 2));
         strict(workshop);
       },
       {"tiny.safetensors: precision 'int16': outputs differ from float32 by ", "expected at most 1e-12"},
       kUseThem},
      {"precision",
       replaced(kConfig, "[control]", "[network]\nprecision = \"int8\"\n\n[control]"),
       {"adult.toml:", ": key 'network.precision': value 'int8', expected one of 'float32', 'int16'"},
       {}},
      {"instruction set",
       replaced(kConfig, "[control]", "[network]\ninstruction_set = \"mmx\"\n\n[control]"),
       {"adult.toml:", ": key 'network.instruction_set': value 'mmx', expected one of 'auto', 'baseline'"},
       {}},
  });
}
