// Where the sources, the programs and the measured recordings of this build are. Benchmarks, studies and
// tests read files of them; an installed program has to look elsewhere where they do not exist.
//
// The paths stand in one small source, so that a compiler's cache serves checkouts in any folder.
#pragma once

#include <filesystem>

namespace patella::checkout {

/// Folder of the sources, absolute.
std::filesystem::path source();

/// Folder that this build was made in.
std::filesystem::path build();

/// Folder of the measured recordings (CMake: PATELLA_DATA_DIR); it may not exist.
std::filesystem::path recordings();

/// `here` where it exists, as it does on the machine that built it, or `installed`.
std::filesystem::path orInstalled(const std::filesystem::path& here, const std::filesystem::path& installed);

}  // namespace patella::checkout
