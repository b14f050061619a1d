#include "tools/diagnose/output/diagnosis_report.hpp"

#include <cmath>
#include <vector>

#include <fmt/format.h>

#include "tools/diagnose/output/correlation_table.hpp"
#include "tools/diagnose/output/power_figures.hpp"
#include "tools/diagnose/output/residual_figures.hpp"
#include "tools/diagnose/output/selection_figures.hpp"
#include "tools/diagnose/output/time_figures.hpp"
#include "tools/diagnose/result/parameter_text.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/report/gnuplot.hpp"
#include "tools/report/html.hpp"
#include "tools/report/palette.hpp"

namespace patella::diagnose {
namespace {

using report::escaped;
using report::Table;
using report::tableText;

const char* colourOf(Verdict verdict) {
  switch (verdict) {
    case Verdict::kEffectFound:
      return report::colour::kBlue;
    case Verdict::kNothingMissing:
      return report::colour::kGreen;
    case Verdict::kUnknownEffect:
      return report::colour::kRed;
    case Verdict::kInsufficientExcitation:
      return report::colour::kGrey;
  }
  return report::colour::kGrey;
}

std::string joinedWords(const std::vector<std::string>& labels) {
  std::string text;
  for (const std::string& label : labels) {
    text += (text.empty() ? "" : "; ") + effectWords(label);
  }
  return text;
}

/// A sign at a number that a reader has to look at twice, with the reasons; empty for others.
std::string mark(const Diagnosis& diagnosis, const std::string& what) {
  std::string reasons;
  for (const Runaway& runaway : diagnosis.runaways) {
    if (runaway.what == what) {
      reasons += (reasons.empty() ? "" : "; ") + runaway.words;
    }
  }
  return reasons.empty() ? "" : " <b class=\"mark\" title=\"" + escaped(reasons) + "\">!</b>";
}

std::string runawayText(const Diagnosis& diagnosis) {
  if (diagnosis.runaways.empty()) {
    return {};
  }
  std::string text = "<section class=\"runaways\">\n<h2>To look at twice</h2>\n<ul>\n";
  for (const Runaway& runaway : diagnosis.runaways) {
    text += "<li><b class=\"mark\">!</b> " + escaped(runaway.words) + "</li>\n";
  }
  return text + "</ul>\n</section>\n";
}

std::string verdictText(const Diagnosis& diagnosis) {
  std::string text = fmt::format(
      "<section class=\"verdict\" style=\"border-color:{}\">\n<h1>{}</h1>\n<p>{}</p>\n",
      colourOf(diagnosis.verdict), escaped(verdictWords(diagnosis.verdict)), escaped(diagnosis.explanation));
  if (!diagnosis.effects.empty()) {
    text += "<ul>\n";
  }
  for (const EffectFinding& effect : diagnosis.effects) {
    text += "<li><b>" + escaped(effectWords(effect)) + "</b>";
    for (std::size_t i = 0; i < effect.parameters.size(); ++i) {
      const ParameterEstimate& estimate = effect.parameters[i];
      text += (i == 0 ? ": " : ", ") + escaped(estimateText(estimate, unitsOf(diagnosis, effect.joint))) +
              mark(diagnosis, fmt::format("{}@{} {}", effect.kind, effect.joint + 1, estimate.name));
    }
    text += escaped(torqueErrorText(effect)) +
            fmt::format(" <span class=\"note\">{}{:.4g} nats</span>",
                        effect.p_value ? fmt::format("p = {:.2g}, ", *effect.p_value) : "", effect.gain);
    if (!effect.indistinguishable_from.empty()) {
      text += "<br>cannot be told from: " + escaped(joinedWords(effect.indistinguishable_from));
    }
    if (!effect.replaces.empty()) {
      text += "<br>in place of what the model declares: " + escaped(joinedWords(effect.replaces));
    }
    if (!effect.asserted()) {
      text += "<br>possibly: " + escaped(effect.not_asserted_because);
    }
    if (!effect.separating_motion.empty()) {
      text += "<br>what would tell: " + escaped(effect.separating_motion);
    }
    text += "</li>\n";
  }
  return text + (diagnosis.effects.empty() ? "" : "</ul>\n") + "</section>\n" + runawayText(diagnosis);
}

/// Error over torque of a joint in percent, or a dash.
std::string percentAt(const std::vector<double>& relative, std::size_t joint) {
  return joint < relative.size() && relative[joint] < runaway::kNoTorque
             ? shortNumber(kPercent * relative[joint])
             : "–";
}

Table errorTable(const Diagnosis& diagnosis) {
  const std::string unit = " / " + unitsOf(diagnosis).torque;
  Table table{.title = "Error of the inverse dynamics",
              .header = {"", "rms" + unit, "held out" + unit, "relative / %", "held out / %",
                         fmt::format("simulated {:.3g} s / {}", diagnosis.simulation_window_s,
                                     unitsOf(diagnosis).position)},
              .rows = {}};
  const auto add = [&](const char* words, const ErrorMeasure& error, std::size_t joint) {
    table.rows.push_back({fmt::format("joint {}, {}", joint + 1, words), numberAt(error.train_rms_Nm, joint),
                          numberAt(error.heldout_rms_Nm, joint), percentAt(error.train_relative, joint),
                          percentAt(error.heldout_relative, joint),
                          numberAt(error.simulation_rms_rad, joint)});
  };
  for (std::size_t joint = 0; joint < diagnosis.before.train_rms_Nm.size(); ++joint) {
    add("model as given", diagnosis.before, joint);
    add("its parameters refitted", diagnosis.refitted, joint);
    add("with what was found", diagnosis.after, joint);
    table.rows.push_back({fmt::format("joint {}, noise floor", joint + 1),
                          numberAt(diagnosis.noise_floor_Nm, joint), "", "", "", ""});
  }
  return table;
}

std::string nominalTable(const Diagnosis& diagnosis) {
  if (diagnosis.nominal.empty()) {
    return {};
  }
  Table table{
      .title = "Nominal parameters", .header = {"", "given", "refitted", "sd", "change / %"}, .rows = {}};
  for (const RefittedParameter& parameter : diagnosis.nominal) {
    const double change = 100.0 * (parameter.refitted / parameter.nominal - 1.0);
    table.rows.push_back({parameter.made_of.empty() ? parameter.name : parameter.made_of,
                          fmt::format("{:.4g}", parameter.nominal), fmt::format("{:.4g}", parameter.refitted),
                          fmt::format("{:.2g}", parameter.sd),
                          std::isfinite(change) ? fmt::format("{:+.1f}", change) : "–"});
    table.marks.push_back(mark(diagnosis, parameter.name));
  }
  return tableText(table);
}

std::string excitationTables(const Diagnosis& diagnosis) {
  const std::string length = unitsOf(diagnosis).position;
  const Excitation& excitation = diagnosis.excitation;
  std::string text;
  if (!excitation.position_range_rad.empty()) {
    Table motion{
        .title = "Motion", .header = {"", "range / " + length, "speed rms / (" + length + "/s)"}, .rows = {}};
    for (std::size_t joint = 0; joint < excitation.position_range_rad.size(); ++joint) {
      motion.rows.push_back({fmt::format("joint {}", joint + 1),
                             numberAt(excitation.position_range_rad, joint),
                             numberAt(excitation.velocity_rms_rad_s, joint)});
    }
    text += tableText(motion);
  }
  Table known{.title = "What this motion can tell", .header = {"", ""}, .rows = {}, .words = true};
  if (!excitation.identifiable.empty()) {
    known.rows.push_back({"identifiable", joinedWords(excitation.identifiable)});
  }
  if (!excitation.not_identifiable.empty()) {
    known.rows.push_back({"not identifiable", joinedWords(excitation.not_identifiable)});
  }
  text += known.rows.empty() ? "" : tableText(known);
  if (!diagnosis.plan_command.empty()) {
    text +=
        "<div class=\"group\"><h3>A motion that would tell</h3>\n<p>Within the limits of the loop's "
        "configuration CONFIG:</p>\n<pre>" +
        escaped(diagnosis.plan_command) + "</pre></div>\n";
  }
  return text;
}

std::string unexplainedTable(const Diagnosis& diagnosis) {
  if (diagnosis.unexplained.empty()) {
    return {};
  }
  Table table{.title = "What the rest depends on",
              .header = {"residual of", "variable", "explains rms / " + unitsOf(diagnosis).torque, "p"},
              .rows = {}};
  for (const Dependence& dependence : diagnosis.unexplained) {
    table.rows.push_back({fmt::format("joint {}", dependence.joint + 1), dependence.variable,
                          shortNumber(dependence.explained_Nm),
                          dependence.p_value ? fmt::format("{:.2g}", *dependence.p_value) : "–"});
  }
  return tableText(table);
}

std::string timingTable(const Diagnosis& diagnosis) {
  if (diagnosis.drive_timing.empty()) {
    return {};
  }
  Table table{.title = "Commanded against measured torque",
              .header = {"", "delay / ms", "lag / ms", "error / %", "with both / %"},
              .rows = {}};
  for (const DriveTiming& timing : diagnosis.drive_timing) {
    table.rows.push_back({fmt::format("joint {}", timing.joint + 1), shortNumber(1e3 * timing.delay_s),
                          shortNumber(1e3 * timing.lag_s), shortNumber(100.0 * timing.relative_error_before),
                          shortNumber(100.0 * timing.relative_error_after)});
  }
  return tableText(table);
}

std::string provenance(const Diagnosis& diagnosis) {
  Table inputs{.title = fmt::format("Recordings (seed {})", diagnosis.seed),
               .header = {"", "SHA-256"},
               .rows = {},
               .words = true};
  for (const InputFile& input : diagnosis.inputs) {
    inputs.rows.push_back({input.path, input.sha256});
  }
  std::string text = tableText(inputs);
  if (!diagnosis.warnings.empty()) {
    text += "<div class=\"group\"><h3>Warnings</h3>\n<ul>\n";
    for (const std::string& warning : diagnosis.warnings) {
      text += "<li>" + escaped(warning) + "</li>\n";
    }
    text += "</ul></div>\n";
  }
  return text;
}

}  // namespace

std::string diagnosisPage(const Diagnosis& diagnosis) {
  std::vector<report::Figure> figures = timeFigures(diagnosis);
  for (const auto& more :
       {residualFigures(diagnosis), powerFigures(diagnosis), selectionFigures(diagnosis)}) {
    figures.insert(figures.end(), more.begin(), more.end());
  }
  const std::vector<std::string> pictures = report::drawSvg(figures);
  std::string body = verdictText(diagnosis);
  body += "<h2>In numbers</h2>\n" + tableText(errorTable(diagnosis)) + "<div class=\"tables\">\n" +
          nominalTable(diagnosis) + unexplainedTable(diagnosis) + excitationTables(diagnosis) +
          timingTable(diagnosis) + "</div>\n";
  body += correlationTable(diagnosis.correlations, unitsOf(diagnosis));
  body += report::figureSections(figures, pictures);
  body += "<h2>Origin</h2>\n" + provenance(diagnosis);
  return report::pageAround("Diagnosis: " + std::string(verdictWords(diagnosis.verdict)), body);
}

}  // namespace patella::diagnose
