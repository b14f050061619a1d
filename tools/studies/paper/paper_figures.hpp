// The paper's figures 3 to 10, of seed 1.
#pragma once

#include <filesystem>

#include "tools/studies/paper/paper_study.hpp"

namespace patella::study {

/// One PNG for each figure that the results have what is needed for, in FOLDER/as_printed and
/// FOLDER/corrected. Throws std::runtime_error without gnuplot, app::FileError where a picture cannot be
/// written.
void drawFigures(const PaperOptions& options, const PaperResults& results,
                 const std::filesystem::path& folder);

}  // namespace patella::study
