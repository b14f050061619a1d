// Table 1 and what it means, as text.
#pragma once

#include <filesystem>
#include <string>

#include "tools/studies/paper/paper_study.hpp"

namespace patella::study {

/// A table in Markdown for each form: every observer and the network on every test, mean ± deviation over
/// seeds.
std::string table1(const PaperResults& results);
/// A line a form, experiment, method and joint.
void writeTable1(const PaperResults& results, const std::filesystem::path& path);
/// In words and with its figures: what the tests of the network say beside each other.
std::string meaning(const PaperResults& results);

}  // namespace patella::study
