// The words that begin a DBC file's statements.
#pragma once

#include <algorithm>
#include <array>
#include <string_view>

namespace patella::can {

/// Statements that do not bear on decoding: checked for form, then dropped.
inline constexpr std::array<std::string_view, 22> kSkippedStatements = {
    "VAL_TABLE_",       "EV_",        "ENVVAR_DATA_", "EV_DATA_",          "SGTYPE_",    "SGTYPE_VAL_",
    "SIG_TYPE_REF_",    "SIG_GROUP_", "BA_REL_",      "BA_DEF_REL_",       "BA_SGTYPE_", "BA_DEF_DEF_REL_",
    "BA_DEF_SGTYPE_",   "BU_SG_REL_", "BU_EV_REL_",   "BU_BO_REL_",        "CAT_DEF_",   "CAT_",
    "SIGTYPE_VALTYPE_", "NS_DESC_",   "FILTER",       "BA_DEF_DEF_SGTYPE_"};
inline constexpr std::array<std::string_view, 14> kReadStatements = {
    "VERSION", "NS_",     "BS_", "BU_",         "BO_",  "SG_",         "BO_TX_BU_",
    "CM_",     "BA_DEF_", "BA_", "BA_DEF_DEF_", "VAL_", "SG_MUL_VAL_", "SIG_VALTYPE_"};

template <typename List>
bool contains(const List& list, std::string_view word) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

inline bool isKeyword(std::string_view word) {
  return contains(kReadStatements, word) || contains(kSkippedStatements, word);
}

}  // namespace patella::can
