// Result of a diagnosis: plain data, which the JSON file, the report and the console show.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/model/model_description.hpp"

namespace patella::diagnose {

enum class Verdict {
  kEffectFound,     ///< `effects` explain what the model lacked
  kNothingMissing,  ///< the residual is within its noise, after the nominal parameters were refitted
  kUnknownEffect,   ///< something is missing that no effect of the library explains; see `unexplained`
  kInsufficientExcitation,  ///< the motion is too poor to tell; see `excitation`
};

/// "effect_found" …
std::string_view verdictName(Verdict verdict) noexcept;

/// A doubt about an answer.
struct Doubt {
  /// In the order in which they count: the first that applies to an answer decides (verdict/verdict.hpp).
  enum class Kind {
    kTooPoor,             ///< the recordings tell nothing, whatever is looked for
    kSharedCause,         ///< one cause on all joints, which no effect of the library has
    kHeldOutDiffers,      ///< something else happens in the held-out part
    kHeldOutWorse,        ///< what explains the fitted part makes the error of the held-out part larger
    kRestingTorque,       ///< encoder and torque of a joint at rest contradict each other
    kRecordingsDisagree,  ///< recordings that were diagnosed together have no common answer
    kUnexplained,         ///< what is left bends like no effect of the library
    kOutweighed,          ///< effects were found, but what stays unexplained is as large as each
    kSingleSinusoids,     ///< several effects were found under single sinusoids
    kJointUnexplained,    ///< much more is left than that on a joint on which no effect is asserted
    kLargeRest,           ///< much more is left than sensors and declared pushes make
    kJointUntold,         ///< next to nothing that acts on a joint would show
    kJointAtRest,         ///< what is missing on a joint that does not move cannot be told
    kPlainEffectsUnseen,  ///< plain effects of three times the noise would not show
    kSomeRest,            ///< more is left than sensors and declared pushes make, which is not nothing
    kParametersMoved,     ///< parameters of the model took up more than their tolerance allows
  };
  using enum Kind;

  Kind kind = kTooPoor;
  std::string words;  ///< one or two sentences for people; empty where `unexplained` has them
};

/// "too_poor" …
std::string_view doubtName(Doubt::Kind kind) noexcept;

struct ParameterEstimate {
  std::string name;  ///< with its unit, as in model files
  double value = 0.0;
  std::array<double, 2> ci95{};
  bool by_factor = false;  ///< a positive number, whose interval lies about it in logarithms
  bool at_bound = false;   ///< the fit stopped at the end of the range in which it may look
};

struct EffectFinding {
  std::string kind;
  int joint = 0;  ///< from 0
  std::vector<ParameterEstimate> parameters;
  /// Half the 95 % interval of the torque of its strengths over that torque, where the parameters are their
  /// logarithms; 1 and more: it may be none.
  std::optional<double> torque_error{};
  /// Family-wise, from the parametric bootstrap; none where something else told.
  std::optional<double> p_value{};
  double gain = 0.0;  ///< log-likelihood that is lost without it, nats
  /// Kinds, or sums "kind+kind", that the recording cannot tell from this one; with "@2" where on another
  /// joint.
  std::vector<std::string> indistinguishable_from;
  std::vector<std::string>
      replaces;                   ///< kinds that the model declares on this joint, in whose place it stands
  std::string separating_motion;  ///< what would tell them apart; empty where nothing needs it
  /// Why it is possible only; empty where it is asserted. The reason completes "possibly: ".
  std::string not_asserted_because{};
  bool asserted() const noexcept { return not_asserted_because.empty(); }
};

/// Motion of a joint (m for a prismatic one) simulated over windows that start at measured states, thinned; a
/// row of NaN stands behind each window.
struct SimulatedMotion {
  std::vector<double> time_s, measured_rad, simulated_rad;
};

/// Errors of the inverse dynamics (torque, N·m; N for a prismatic joint), per joint.
struct ErrorMeasure {
  std::vector<double> train_rms_Nm;
  std::vector<double> heldout_rms_Nm;
  std::vector<double> train_relative;  ///< ‖residual‖ / ‖torque‖ in the analysis band
  std::vector<double> heldout_relative;
  std::vector<double> simulation_rms_rad;    ///< forward simulation from measured states, held-out data
  std::vector<SimulatedMotion> simulated{};  ///< its curves, for the pictures
};

/// One bar of the ranking: what adding this candidate next would have bought.
struct CandidateScore {
  std::string label;       ///< "coulomb_friction@1"
  double gain = 0.0;       ///< log-likelihood gain, nats
  double threshold = 0.0;  ///< gain that chance alone reaches with the family-wise probability allowed
  bool accepted = false;
  std::string refused_because;  ///< gate that it failed: "sign: stribeck_level_Nm", "bic", "stability", …
};

struct SelectionStep {
  std::vector<CandidateScore> ranking;  ///< best first
  std::string accepted;                 ///< label, or empty where the search ended here
  double p_value = 1.0;
  double chance = 0.0;  ///< fall of −2 log-likelihood, less the cost of its parameters, that chance brings
};

struct Excitation {
  std::vector<double> position_range_rad;  ///< per joint
  std::vector<double> velocity_rms_rad_s;
  std::vector<std::string> identifiable;  ///< "coulomb_friction@1", "nominal I2 + m2 lc2²" …
  std::vector<std::string> not_identifiable;
};

/// The smallest size of an effect that was looked for and not found, which four in five recordings like this
/// one would have revealed.
struct Revealed {
  std::string kind;
  int joint = 0;               ///< from 0
  std::string parameter;       ///< with its unit, as in model files
  double smallest_size = 0.0;  ///< of that parameter; NaN where the torque does not grow with one number
  /// All parameters of an effect of that size, in the order of its descriptor: sizes go with a shape, as the
  /// mass of a payload does with its distance. Empty where there is no such size.
  std::vector<double> parameters;
  double torque_rms_Nm = 0.0;    ///< infinite where no size would have shown
  double share_of_torque = 0.0;  ///< of its joint
};

/// Variables on which the remaining residual depends, strongest first.
struct Dependence {
  int joint = 0;                    ///< whose residual
  std::string variable;             ///< "dq1", "q2", "ddq1", "tau1", "time", "ddq1*q2", …
  double explained_Nm = 0.0;        ///< rms of what a smooth function of the variable explains
  std::optional<double> p_value{};  ///< none where no chance was drawn
};

struct RefittedParameter {
  std::string name;
  std::string made_of{};  ///< "ZZ1 + 0.0529 M2" for a base parameter of a chain; empty otherwise
  double nominal = 0.0;
  double refitted = 0.0;
  double sd = 0.0;
  double known_sd = 0.0;              ///< standard deviation before the recording was looked at
  std::array<double, 2> tolerated{};  ///< where it is within its tolerance
  bool is_ratio = true;               ///< its tolerance is a factor
  bool isBeyond() const noexcept { return refitted < tolerated[0] || refitted > tolerated[1]; }
};

/// Correlations of the errors of parameters that were fitted together.
struct Correlations {
  std::vector<std::string> parameters;      ///< "mass_kg[1]", "coulomb_friction@1 level_Nm"
  std::vector<std::vector<double>> matrix;  ///< −1…1; NaN where nothing is uncertain
};

/// A number that a reader has to look at twice: at its bound, unknown, or out of its tolerance.
struct Runaway {
  std::string what;       ///< "mass_kg[1]", "coulomb_friction@1 level_Nm", "error@1"
  double nominal = 0.0;   ///< declared or given; NaN for what the model did not hold
  double refitted = 0.0;  ///< NaN where it vanished
  double limit = 0.0;     ///< tolerance (relative) or bound that it met; NaN where there is none
  std::string words;      ///< one sentence for people
  bool resized = false;   ///< a declared effect, of another size than declared
};

/// Curves for the pictures, in the analysis band and at its rate.
struct JointCurves {
  std::vector<double> time_s;
  std::vector<double> position_rad, velocity_rad_s, acceleration_rad_s2, torque_Nm;
  std::vector<double> residual_before_Nm, residual_after_Nm;
  /// Per EMG channel; empty where the recordings have none.
  std::array<std::vector<double>, kMaxEmgChannels> activation;
  std::vector<bool> heldout;
};

/// A joint's residual under the model that was found, below the band's edge: rms, N·m.
struct RestOfJoint {
  double torque_Nm = 0.0;     ///< of the drive; of the model's load where the joint is not driven
  double structure_Nm = 0.0;  ///< beyond noise
  double noise_Nm = 0.0;      ///< what sensors and declared pushes make
};

struct InputFile {
  std::string path;
  std::string sha256;
};

struct DriveTiming {
  int joint = 0;
  double delay_s = 0.0;
  double lag_s = 0.0;
  double relative_error_before = 0.0;
  double relative_error_after = 0.0;
};

struct Diagnosis {
  Verdict verdict = Verdict::kNothingMissing;
  std::string explanation;           ///< one or two sentences for people, and the remarks
  std::vector<std::string> remarks;  ///< sentences on what the answer leaves open
  std::vector<Doubt> doubts;
  std::vector<EffectFinding> effects;
  ErrorMeasure before;    ///< the model as given
  ErrorMeasure refitted;  ///< its nominal parameters refitted, nothing added
  ErrorMeasure after;     ///< with what was found
  std::vector<double> noise_floor_Nm;
  std::vector<RestOfJoint> rests;  ///< of each joint, on the data that were fitted
  double simulation_window_s = 0.0;
  Excitation excitation;
  std::vector<Revealed> revealed;  ///< what is commonly missing first, and of it what shows least
  std::vector<Dependence> unexplained;
  std::vector<RefittedParameter> nominal;
  Correlations correlations;
  std::vector<Runaway> runaways;
  std::vector<DriveTiming> drive_timing;  ///< where commanded and measured torque were both recorded
  std::vector<SelectionStep> steps;
  std::vector<std::string> warnings;
  std::vector<JointCurves> curves;
  double curves_rate_Hz = 0.0;
  std::uint64_t seed = 0;
  std::vector<InputFile> inputs;
  model::ModelDescription extended;  ///< what model.extended.toml holds
  std::string plan_command;  ///< that plans a motion which tells more; empty where the motion told enough
};

}  // namespace patella::diagnose
