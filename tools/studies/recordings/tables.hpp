// Results as text and as pictures.
#pragma once

#include <filesystem>
#include <span>
#include <string>

#include "tools/studies/recordings/emg_study.hpp"
#include "tools/studies/recordings/pendulum_study.hpp"

namespace patella::study {

std::string emgTable(std::span<const EmgStudy> studies);
std::string pendulumTable(std::span<const PendulumStudy> studies);

/// Throw std::runtime_error when gnuplot is missing or fails.
void drawEmg(std::span<const EmgStudy> studies, const std::filesystem::path& picture);
void drawPendulum(const PendulumStudy& study, const std::filesystem::path& picture);

}  // namespace patella::study
