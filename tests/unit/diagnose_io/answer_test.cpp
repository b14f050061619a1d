// The answer on the console.
#include "tools/diagnose/output/answer.hpp"

#include <algorithm>
#include <chrono>
#include <limits>
#include <sstream>

#include <doctest/doctest.h>

#include "tests/unit/diagnose_io/made_up_diagnosis.hpp"

using namespace patella;

namespace {

std::string answer(const diagnose::Diagnosis& diagnosis) {
  std::ostringstream out;
  diagnose::printAnswer(diagnosis, "out/knee", out);
  return out.str();
}

}  // namespace

TEST_CASE("an answer has the verdict, parameters, rivals, errors and the way to the files") {
  const std::string text = answer(test::madeUpDiagnosis());
  for (const char* part :
       {"Missing effect found. A spring and dry friction",
        "coulomb friction on joint 2: level 1.48 [1.42, 1.54] N·m",
        "(p = 0.002); or presliding hysteresis, viscous friction on joint 1 + torque bias",
        "error of joint 2 on held-out data, N·m: 2.4 as given, 1.3 refitted, 0.06 extended; noise floor 0.05",
        "to look at twice: the model's mass left its tolerance\n", "clipped at 12",
        "files in out/knee: report.html, diagnosis.json, model.extended.toml"}) {
    CAPTURE(part);
    CHECK(text.find(part) != std::string::npos);
  }
}

TEST_CASE("an answer has what is asserted before what is possible, and seventeen lines where little is") {
  diagnose::Diagnosis many = test::madeUpDiagnosis();
  const diagnose::EffectFinding asserted = many.effects.front();
  many.effects.resize(9, asserted);
  many.warnings.resize(20, "something");
  many.runaways.resize(9, many.runaways.front());
  for (std::size_t i = 0; i < 8; ++i) {
    many.effects[i].not_asserted_because = "of a reason";
  }
  const std::string text = answer(many);
  CHECK(std::count(text.begin(), text.end(), '\n') == 17);
  CHECK(text.find("and 5 more that are possible, in the report\n") != std::string::npos);
  CHECK(text.find("; and 5 more in the report\n") != std::string::npos);
  CHECK(text.find("and 17 more in the report") != std::string::npos);
  const std::size_t first = text.find("\n  linear stiffness on joint");
  CHECK(text.substr(first, text.find('\n', first + 1) - first).find("possibly") == std::string::npos);

  many.effects.assign(9, asserted);
  const std::string all = answer(many);
  CHECK(all.find("that are possible") == std::string::npos);
  CHECK(std::count(all.begin(), all.end(), '\n') == 17 + 9 - 5);
}

TEST_CASE("an answer of a motion that was too poor has the command that plans a better one") {
  diagnose::Diagnosis poor = test::madeUpDiagnosis();
  CHECK(answer(poor).find("--plan") == std::string::npos);
  poor.plan_command = "patella-diagnose --plan --config CONFIG";
  CHECK(answer(poor).find("configuration CONFIG:\n    patella-diagnose --plan --config CONFIG\n") !=
        std::string::npos);
}

TEST_CASE("an answer tells what would have shown from what would not") {
  diagnose::Diagnosis diagnosis = test::madeUpDiagnosis();
  const double never = std::numeric_limits<double>::infinity();
  diagnosis.revealed = {{.kind = "coulomb_friction",
                         .joint = 0,
                         .parameter = "level_Nm",
                         .smallest_size = never,
                         .parameters = {},
                         .torque_rms_Nm = never}};
  CHECK(answer(diagnosis).find("  would not show at any size: coulomb friction on joint 1\n") !=
        std::string::npos);
  CHECK(answer(diagnosis).find("would have shown") == std::string::npos);
}

TEST_CASE("without held-out data the error is that of the data") {
  const std::string text = answer(test::madeUpPostures());
  CHECK(text.find("error of joint 1, N·m: 0.1 as given") != std::string::npos);
}

TEST_CASE("progress is one line for each stage and ten seconds, or one that changes on a terminal") {
  std::ostringstream file;
  {
    diagnose::ProgressLine progress(file, false);
    progress.at("columns", 0.0);
    progress.at("search", 0.0);
    progress.at("search", 0.5);
    progress.at("errors", 0.0);
  }
  CHECK(file.str() == "columns\nsearch\nerrors\n");
  std::ostringstream slow;
  {
    std::chrono::steady_clock::time_point now;
    diagnose::ProgressLine progress(slow, false, [&] { return now; });
    for (int second = 0; second < 25; ++second) {
      progress.at("search", 0.04 * second);
      now += std::chrono::seconds(1);
    }
  }
  CHECK(slow.str() == "search\nsearch 40 %\nsearch 80 %\n");
  std::ostringstream terminal;
  {
    diagnose::ProgressLine progress(terminal, true);
    progress.at("search", 0.0);
    progress.at("search", 0.501);
    progress.at("search", 0.502);
  }
  CHECK(terminal.str() == "\r\033[Ksearch 0 %\r\033[Ksearch 50 %\r\033[K");
}
