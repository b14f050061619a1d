// A model is read or refused; what is read can be made, evaluated, and written so that it reads the same.
#include "firmware_app/files/file_error.hpp"
#include "firmware_app/files/model_file.hpp"
#include "tests/fuzz/fuzz_input.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace patella;
  try {
    const model::ModelDescription description =
        app::parseModel(fuzz::expanded(fuzz::text(data, size)), "fuzz.toml");
    model::DynamicsModel model = model::makeModel(description);
    model::EffectInput input;
    for (JointVector* vector : {&input.q, &input.dq, &input.torque_Nm}) {
      vector->setConstant(model.joints(), 0.1);
    }
    model.reset(input);
    model.evaluate(input);
    app::parseModel(app::modelText(description), "again.toml");
  } catch (const app::FileError&) {
    // refused with a line
  }
  return 0;
}
