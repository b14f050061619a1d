// patella-diagnose --plan: its options, and what it does.
#pragma once

#include <string>

namespace patella::diagnose {

/// Whether the arguments ask for a plan.
bool asksForPlan(int argc, const char* const* argv);
/// The options of --plan, as its --help shows them.
std::string planHelp();
/// Does what the arguments say, and returns the exit status.
int runPlan(int argc, char** argv);

}  // namespace patella::diagnose
