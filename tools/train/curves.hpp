// Learning curves as a picture.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "tools/train/trainer.hpp"

namespace patella::train {

/// Losses over epochs as PNG; the epoch that is kept is marked. Throws as report::drawPng.
void drawCurves(std::span<const Epoch> curve, int kept_epoch, const std::string& title,
                const std::filesystem::path& path);

}  // namespace patella::train
