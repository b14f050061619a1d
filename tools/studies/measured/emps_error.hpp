// The error by which the EMPS benchmark compares models of its axis.
#pragma once

#include "core/model/model_description.hpp"
#include "tools/recordings/recording.hpp"

namespace patella::study {

/// 100 ‖y − ŷ‖₂ / ‖y‖₂ of the drive's force y and the model's inverse dynamics ŷ, over the parts of a
/// recording.
struct RelativeError {
  double train_percent = 0.0;    ///< rows before `train_share` of the recording
  double heldout_percent = 0.0;  ///< the rest
  double all_percent = 0.0;
};

/// As in the benchmark: position through a Butterworth low-pass of 4th order and 100 Hz forward and backward,
/// rates by central differences, 49 samples dropped at both ends, one in ten of the others kept. The
/// published symmetric model comes to 4.08 %, as published. Throws std::invalid_argument for anything but one
/// joint in one stretch of at least 1 s. Source: Janot, Gautier and Brunot 2019, Data Set and Reference
/// Models of EMPS, Nonlinear System Identification Benchmarks.
RelativeError relativeError(const diagnose::Recording& recording, const model::ModelDescription& model,
                            double train_share);

}  // namespace patella::study
