// patella-train: a network for the loop, from its recordings.
#include <iostream>

#include "tools/options/run_program.hpp"
#include "tools/train/commands.hpp"

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  using namespace patella::train;
  CLI::App app("Trains the network that the loop loads, from recordings, and tells how good it is on others.",
               "patella-train");
  app.set_version_flag("--version", std::string("patella-train ") + PATELLA_VERSION);
  app.require_subcommand(1);
  Arguments fit_arguments;
  Arguments score_arguments;
  CLI::App& fit_command = *app.add_subcommand("fit", "Train, and score what was held out.");
  CLI::App& score_command = *app.add_subcommand("score", "Score a network on recordings it has not seen.");
  declareFit(fit_command, fit_arguments);
  declareScore(score_command, score_arguments);
  std::filesystem::path to_seal;
  CLI::App& seal_command = *app.add_subcommand(
      "seal", "Put a digest into weights from elsewhere, so that the loop can tell when they are damaged.");
  seal_command.add_option("FILE", to_seal, "safetensors; rewritten in F32")->required();
  return patella::options::runProgram(app, argc, argv, [&] {
    if (fit_command.parsed()) {
      fit(fit_arguments, std::cout);
    } else if (seal_command.parsed()) {
      seal(to_seal, std::cout);
    } else {
      score(score_arguments, std::cout);
    }
  });
}
