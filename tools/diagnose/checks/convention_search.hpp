// Which convention a recording was made with, by one score for all: before any effect is thought of.
#pragma once

#include <vector>

#include "tools/diagnose/checks/convention_score.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::diagnose {

/// Conventions of single joints and pairs of them beside those of all joints, or the latter alone.
enum class Extent { kEach, kAllTogether };

/// Every convention with its reading; zeros, shifts and factors of torque where they explain most.
std::vector<ReadAs> readings(Reader& reader, const Reading& given, const ColumnNames& names,
                             Extent extent = Extent::kEach);

ColumnNames columnNames(const model::ModelDescription& model);

/// Those that are believed (convention_score.hpp): the best, and what is as good. Two at once where one alone
/// leaves more than machines leave. Empty where the recording is in the model's own.
std::vector<ReadAs> wrongConventions(Reader& reader, const Reading& given, const ColumnNames& names);

/// Throws WrongConvention, naming recording, conventions, what the model explains with them and as given,
/// where there are wrong ones.
void requireConventions(const Recording& recording, const model::ModelDescription& model);

/// Throws WrongConvention where angles are beyond two turns, unless the model explains them
/// better as they are.
void requireAngles(const Recording& recording, const model::ModelDescription& model);

}  // namespace patella::diagnose
