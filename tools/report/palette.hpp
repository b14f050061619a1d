// The colours of every picture: those of Okabe and Ito (2008), which people who confuse red and green can
// tell apart, and shades of grey. One colour has one meaning within a picture, which names it.
#pragma once

namespace patella::report::colour {

inline constexpr const char* kBlack = "#222222";
inline constexpr const char* kWhite = "#FFFFFF";
inline constexpr const char* kGrey = "#9A9A9A";
inline constexpr const char* kPaleGrey = "#B9BFC4";
inline constexpr const char* kBlue = "#0072B2";
inline constexpr const char* kPaleBlue = "#A5CDE8";
inline constexpr const char* kSky = "#56B4E9";
inline constexpr const char* kGreen = "#009E73";
inline constexpr const char* kPaleGreen = "#BFE3C6";
inline constexpr const char* kOrange = "#E69F00";
inline constexpr const char* kRed = "#D55E00";  ///< vermilion
inline constexpr const char* kPaleRed = "#F3C3A0";
inline constexpr const char* kPurple = "#CC79A7";
inline constexpr const char* kAlarm = "#B00020";  ///< limits and thresholds
inline constexpr const char* kFaultShade = "#F6D5CC";
inline constexpr const char* kLimitShade = "#FBEFC9";
inline constexpr const char* kHeldOutShade = "#EEF1F4";  ///< stretches that nothing was fitted to
inline constexpr const char* kAxis = "#777777";
inline constexpr const char* kGrid = "#E4E4E4";

}  // namespace patella::report::colour
