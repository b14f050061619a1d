// `patella-diagnose` run as a user runs it, and a knee for it.
#pragma once

#include <string>
#include <vector>

#include "tests/support/program.hpp"

namespace patella::test {

Outcome diagnose(const std::vector<std::string>& arguments);

/// A recording of one joint that obeys I·ddq = τ − m·g·cos q, with dry friction that `loss_Nm` has, as CSV
/// whose stamps begin at `start_s`.
std::string kneeCsv(double loss_Nm, double duration_s, double start_s = 0.0);
/// The model of that knee without friction.
std::string kneeModel();

}  // namespace patella::test
