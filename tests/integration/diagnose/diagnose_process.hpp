// `patella` and `patella-diagnose` run as a user runs them.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace patella::test {

/// How a process ended.
struct Outcome {
  int exit_status = -1;  ///< −1 when a signal ended it
  std::string output;
  std::string errors;
  double peak_MB = 0.0;  ///< of memory
};

/// Arguments are taken as they are, without a shell.
Outcome runProgram(const std::string& executable, const std::vector<std::string>& arguments);
Outcome diagnose(const std::vector<std::string>& arguments);

/// Paths of everything below a folder, from it.
std::set<std::string> listing(const std::filesystem::path& folder);

/// A recording of one joint that obeys I·ddq = τ − m·g·cos q, with dry friction that `loss_Nm` has, as CSV
/// whose stamps begin at `start_s`.
std::string kneeCsv(double loss_Nm, double duration_s, double start_s = 0.0);
/// The model of that knee without friction.
std::string kneeModel();

}  // namespace patella::test
