#include "tools/bench/diagnose/conventions.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>

#include "core/model/effect.hpp"
#include "tools/bench/diagnose/measured_rigs.hpp"
#include "tools/bench/diagnose/mistakes.hpp"
#include "tools/diagnose/checks/plausibility.hpp"
#include "tools/diagnose/diagnose.hpp"
#include "tools/diagnose/regression/dataset.hpp"
#include "tools/diagnose/regression/elementary.hpp"
#include "tools/diagnose/regression/joint_rest.hpp"

namespace patella::bench {
namespace {

using diagnose::Dataset;
using diagnose::Diagnosis;
using diagnose::Recording;

/// Share of each joint's load that a model may leave and still explain a recording.
constexpr double kExplains = 0.3;
/// A mistake that makes the model's error on every joint grow by less is one that nothing can tell: some
/// fifty independent values in ten seconds know a root mean square to within a tenth.
constexpr double kGrows = 1.2;

struct Source {
  const MeasuredRecording* measured = nullptr;
  model::ModelDescription model;
  const char* whose = "";
  std::vector<double> error{};  ///< of the recording as it is
};

std::vector<double> errorOf(const Dataset& data, const model::ModelDescription& model) {
  model::DynamicsModel dynamics = model::makeModel(model);
  const diagnose::Column left = data.driveTorque() - data.modelTorque(dynamics);
  std::vector<double> error = diagnose::loads_Nm(data, dynamics.mechanism());
  for (int joint = 0; joint < data.joints(); ++joint) {
    double& one = error[static_cast<std::size_t>(joint)];
    one = diagnose::jointRms(data, left, joint) / std::max(one, 1e-12);
  }
  return error;
}

std::vector<double> errorOf(const Recording& recording, const model::ModelDescription& model) {
  return errorOf(Dataset(std::span(&recording, 1), diagnose::kCoarse), model);
}

// The makers' model with the dry and viscous friction that explains most of what it leaves of the recording.
model::ModelDescription withFriction(const Recording& recording, model::ModelDescription model) {
  const Dataset data(std::span(&recording, 1), diagnose::kCoarse);
  model::DynamicsModel dynamics = model::makeModel(model);
  const diagnose::Column left = data.driveTorque() - data.modelTorque(dynamics);
  for (int joint = 0; joint < data.joints(); ++joint) {
    const Eigen::VectorXd rest = left.segment(joint * data.rows(), data.rows());
    const double speed_rad_s = data.variable([=](const diagnose::Series& series, std::size_t i) {
                                     return series.states[i].dq[joint];
                                   })
                                   .norm() /
                               std::sqrt(static_cast<double>(data.rows()));
    const std::array<std::vector<double>, 2> units{{{1.0}, {1.0, 0.05 * std::max(speed_rad_s, 1e-3)}}};
    constexpr std::array kKinds{"viscous_friction", "coulomb_friction"};
    std::array<Eigen::VectorXd, 2> columns;
    for (std::size_t k = 0; k < columns.size(); ++k) {
      const auto effect = model::makeEffect(kKinds[k], joint, dynamics.mechanism(), units[k]);
      columns[k] = data.effectTorque(*effect).segment(joint * data.rows(), data.rows());
    }
    // Neither below zero, in turn.
    std::array<double, 2> size{};
    constexpr int kRounds = 50;
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t k = 0; k < columns.size(); ++k) {
        const Eigen::VectorXd other = rest - size[1 - k] * columns[1 - k];
        size[k] = std::max(0.0, columns[k].dot(other) / std::max(1e-300, columns[k].squaredNorm()));
      }
    }
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (size[k] > 0.0) {
        std::vector<double> parameters = units[k];
        parameters[0] = size[k];
        model.effects.push_back({.kind = kKinds[k], .joint = joint, .parameters = parameters});
      }
    }
  }
  return model;
}

bool isRevolute(const model::ModelDescription& model) {
  return !std::holds_alternative<model::PrismaticJointParameters>(model.mechanism);
}

// "named", "wrong", "effect" …
struct Answer {
  std::string mark;
  std::string words;
  std::size_t named = 0;
};

std::string markOf(const Diagnosis& diagnosis) {
  switch (diagnosis.verdict) {
    case diagnose::Verdict::kNothingMissing:
      return "nothing";
    case diagnose::Verdict::kEffectFound:
      return "effect";
    default:
      return diagnosis.effects.empty() ? "unknown" : "effect";
  }
}

// How many of the mistakes are named by what puts them right. Two conventions for one mistake are wrong.
std::size_t countNamed(const std::vector<Mistake>& mistakes, const std::vector<diagnose::Convention>& named) {
  return static_cast<std::size_t>(
      std::count_if(mistakes.begin(), mistakes.end(), [&](const Mistake& mistake) {
        return std::any_of(named.begin(), named.end(), [&](const diagnose::Convention& one) {
          return one.parts.size() <= mistakes.size() && anyPart(one, mistake.is);
        });
      }));
}

// Whether nothing can tell the copy, put right as named, from the recording. Two mistakes may be the same as
// another one: all angles with the other sign and one of them turned back.
bool putsRight(const diagnose::Convention& named, const Recording& copy, const Source& source) {
  const std::vector<double> error =
      errorOf(Dataset(std::span(&copy, 1), diagnose::kCoarse).changed(named.correct), source.model);
  for (std::size_t j = 0; j < error.size(); ++j) {
    if (error[j] > kGrows * source.error[j]) {
      return false;
    }
  }
  return true;
}

Answer answerTo(const Recording& recording, const Source& source, const std::vector<Mistake>& mistakes,
                bool judge_only) {
  try {
    if (judge_only) {
      diagnose::requirePlausible(std::span(&recording, 1), source.model);
      return {.mark = "believed", .words = {}};
    }
    const Diagnosis diagnosis = diagnose::diagnose(std::span(&recording, 1), {}, source.model, {});
    std::string found(diagnose::verdictName(diagnosis.verdict));
    for (const diagnose::EffectFinding& effect : diagnosis.effects) {
      found += fmt::format(" {}@{}", effect.kind, effect.joint + 1);
    }
    return {.mark = markOf(diagnosis), .words = found};
  } catch (const diagnose::WrongConvention& wrong) {
    const auto& named = wrong.conventions();
    const std::size_t right = countNamed(mistakes, named);
    const bool is_right =
        right == mistakes.size() ||
        (mistakes.size() > 1 && std::any_of(named.begin(), named.end(), [&](const diagnose::Convention& one) {
           return putsRight(one, recording, source);
         }));
    const char* mark = is_right ? "named" : right > 0 ? "one of them" : "wrong";
    return {.mark = mark, .words = wrong.what(), .named = named.size()};
  } catch (const std::invalid_argument& refused) {
    return {.mark = "wrong", .words = refused.what()};
  }
}

std::vector<Source> sourcesOf(const std::vector<MeasuredRecording>& all, std::size_t& unexplained) {
  std::vector<Source> sources;
  for (const MeasuredRecording& measured : all) {
    std::vector<Source> both{{.measured = &measured, .model = measured.model, .whose = "published"},
                             {.measured = &measured,
                              .model = withFriction(measured.recording, measured.model),
                              .whose = "with friction"}};
    for (Source& source : both) {
      source.error = errorOf(measured.recording, source.model);
      const bool explained = std::all_of(source.error.begin(), source.error.end(),
                                         [](double error) { return error < kExplains; });
      std::fprintf(stderr, "%s\n",
                   fmt::format("{}, {} model: leaves {:.2f}{}", measured.name, source.whose,
                               fmt::join(source.error, " and "), explained ? "" : ", left out")
                       .c_str());
      unexplained += explained ? 0 : 1;
      if (explained) {
        sources.push_back(std::move(source));
      }
    }
  }
  return sources;
}

bool tells(const Source& source, const Recording& copy) {
  const std::vector<double> error = errorOf(copy, source.model);
  for (std::size_t j = 0; j < error.size(); ++j) {
    if (error[j] > kGrows * source.error[j]) {
      return true;
    }
  }
  return false;
}

// Of different kinds; fewer than `count` where one was drawn that this recording cannot have.
std::vector<Mistake> drawMistakes(const Source& source, std::size_t count, Random& random) {
  std::vector<Mistake> mistakes;
  for (std::size_t i = 0; i < count; ++i) {
    std::optional<Mistake> one = drawMistake(source.measured->recording, isRevolute(source.model), random);
    if (one && std::none_of(mistakes.begin(), mistakes.end(),
                            [&](const Mistake& other) { return other.kind == one->kind; })) {
      mistakes.push_back(std::move(*one));
    }
  }
  return mistakes;
}

class Table {
 public:
  explicit Table(const std::filesystem::path& folder) {
    if (!folder.empty()) {
      std::filesystem::create_directories(folder);
      file_.open(folder / "conventions.csv");
      file_ << "case,recording,model,mistake,mark,named,answer\n";
    }
  }

  void add(const std::string& name, const Source& source, const std::string& kind, const std::string& text,
           const Answer& answer) {
    ++counts_[kind][answer.mark];
    if (answer.mark == "named") {
      most_named_ = std::max(most_named_, answer.named);
      alone_ += answer.named == 1 ? 1 : 0;
    }
    const std::string row = fmt::format("{},{},{},{},{},{},\"{}\"", name, source.measured->name, source.whose,
                                        text, answer.mark, answer.named, answer.words);
    std::fprintf(stderr, "%s\n", row.c_str());
    if (file_.is_open()) {
      file_ << row << "\n" << std::flush;
    }
  }

  std::string summary() const {
    constexpr std::array kMarks{"named", "one of them", "wrong", "effect", "nothing", "unknown", "believed"};
    std::string text = fmt::format("  {:<26}{:>8}", "", "copies");
    for (const char* mark : kMarks) {
      text += fmt::format("{:>12}", mark);
    }
    text += "\n";
    std::map<std::string, std::size_t> sum;
    const auto line = [&](const std::string& name, const std::map<std::string, std::size_t>& counts) {
      std::size_t all = 0;
      std::string cells;
      for (const char* mark : kMarks) {
        const auto found = counts.find(mark);
        const std::size_t count = found == counts.end() ? 0 : found->second;
        all += count;
        cells += fmt::format("{:>12}", count);
      }
      text += fmt::format("  {:<26}{:>8}{}\n", name, all, cells);
    };
    for (const auto& [kind, counts] : counts_) {
      if (kind != kPlain) {
        line(kind, counts);
        for (const auto& [mark, count] : counts) {
          sum[mark] += count;
        }
      }
    }
    line("all", sum);
    if (const auto plain = counts_.find(kPlain); plain != counts_.end()) {
      line(kPlain, plain->second);
    }
    return text + fmt::format("  {} named alone, at most {} together\n", alone_, most_named_);
  }

  static constexpr const char* kPlain = "plain";

 private:
  std::ofstream file_;
  std::map<std::string, std::map<std::string, std::size_t>> counts_;
  std::size_t most_named_ = 0, alone_ = 0;
};

}  // namespace

std::string runConventions(const ConventionOptions& options) {
  const std::vector<MeasuredRecording> all = measuredRecordings(options.data, options.source);
  std::size_t unexplained = 0, symmetries = 0;
  const std::vector<Source> sources = sourcesOf(all, unexplained);
  Table table(options.out);
  for (const Source& source : sources) {
    table.add("plain", source, Table::kPlain, "",
              answerTo(source.measured->recording, source, {}, options.judge_only));
  }
  Random random(options.seed);
  for (std::size_t done = 0; done < options.cases;) {
    const Source& source = sources[random.below(sources.size())];
    const std::vector<Mistake> mistakes = drawMistakes(source, options.mistakes, random);
    if (mistakes.size() < options.mistakes) {
      continue;
    }
    Recording copy = source.measured->recording;
    std::string texts;
    bool all_tell = true;
    for (const Mistake& mistake : mistakes) {
      Recording alone = source.measured->recording;
      mistake.make(alone);
      mistake.make(copy);
      all_tell = all_tell && tells(source, alone);
      texts += (texts.empty() ? "" : "; ") + mistake.text;
    }
    if (!all_tell || !tells(source, copy)) {
      ++symmetries;
      continue;
    }
    const std::string kind = mistakes.size() == 1 ? mistakes.front().kind : "two mistakes";
    table.add(std::to_string(done), source, kind, texts,
              answerTo(copy, source, mistakes, options.judge_only));
    ++done;
  }
  return table.summary() +
         fmt::format(
             "  not drawn: {} mistakes that leave the model's error as it is; {} recordings with a "
             "model that leaves more than 30 % of a joint's load\n",
             symmetries, unexplained);
}

}  // namespace patella::bench
