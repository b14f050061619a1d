// patella-study-sampler: accuracy of the finite-time sampler, as the paper prints it and in its implicit
// form, in the paper's two experiments.
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include "core/estimation/implicit_sampler.hpp"
#include "core/estimation/printed_sampler.hpp"
#include "core/model/presets.hpp"
#include "core/signal/butterworth.hpp"
#include "sim/paper_experiment.hpp"
#include "tools/options/number_range.hpp"
#include "tools/options/run_program.hpp"

namespace {

using patella::JointVector;
using patella::estimation::ImplicitSampler;
using patella::estimation::Observer;
using patella::estimation::ObserverInput;
using patella::estimation::PrintedSampler;
using patella::estimation::SamplerParameters;
using patella::sim::PaperExperiment;
using patella::sim::PaperSample;

constexpr double kSettling_s = 1.0;  // left out of the figures
constexpr double kNoise = 0.01;      // standard deviation, rad and rad/s
constexpr double kCutoff_Hz = 5.0;   // of the low-pass behind the sampler

struct Options {
  double seconds = 50.0;
  std::uint64_t seed = 1;
  std::string out;
};

enum class Noise : std::uint8_t { kNone, kVelocity, kBothStates };

struct Run {
  Noise noise = Noise::kNone;
  double cutoff_Hz = 0.0;  // 0: no low-pass
  bool stamp_mid_step = false;
};

struct Error {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Vector2d maximum = Eigen::Vector2d::Zero();
};

struct Sampler {
  const char* name;
  bool averages_over_step;  // the estimate belongs to the middle of the step
  std::unique_ptr<Observer> (*make)();
};

const std::array kSamplers{
    Sampler{"printed", false,
            []() -> std::unique_ptr<Observer> {
              return std::make_unique<PrintedSampler>(SamplerParameters{.delta = 0.1});  // as in the paper
            }},
    Sampler{
        "implicit", true,
        []() -> std::unique_ptr<Observer> { return std::make_unique<ImplicitSampler>(SamplerParameters{}); }},
};

/// |f_u − f_s| after the settling time. A filtered estimate is compared with f_u at the sample, its lag
/// included; an unfiltered one with f_u at the time to which it belongs.
Error measure(Observer& observer, const std::vector<PaperSample>& samples, const Run& run,
              std::uint64_t seed) {
  patella::model::DynamicsModel model = makeModel(patella::model::paperLeg());
  const double dt = samples[1].time_s - samples[0].time_s;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> noise(0.0, kNoise);
  std::array<patella::signal::BiquadCascade, 2> filters;
  if (run.cutoff_Hz > 0.0) {
    filters.fill(patella::signal::lowPass(2, run.cutoff_Hz, 1.0 / dt));
  }

  Error error;
  double count = 0.0;
  for (std::size_t k = 0; k < samples.size(); ++k) {
    ObserverInput input{{}, samples[k].q, samples[k].dq, samples[k].torque_Nm, dt};
    for (int joint = 0; joint < 2; ++joint) {
      input.dq[joint] += run.noise != Noise::kNone ? noise(random) : 0.0;
      input.q[joint] += run.noise == Noise::kBothStates ? noise(random) : 0.0;
    }
    input.terms = model.evaluate({.q = input.q, .dq = input.dq, .torque_Nm = input.torque_Nm});
    if (k == 0) {
      observer.reset(input);
      continue;
    }
    JointVector estimate = observer.update(input);
    for (std::size_t joint = 0; joint < 2; ++joint) {
      estimate[static_cast<int>(joint)] = filters[joint].step(estimate[static_cast<int>(joint)]);
    }
    if (samples[k].time_s > kSettling_s) {
      const Eigen::Vector2d difference =
          ((run.stamp_mid_step ? samples[k].f_u_mid_step : samples[k].f_u) - estimate).cwiseAbs();
      error.mean += difference;
      error.maximum = error.maximum.cwiseMax(difference);
      count += 1.0;
    }
  }
  error.mean /= count;
  return error;
}

std::string cell(double value) {
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), "%.3g", value);
  return text.data();
}

void row(std::ostream& out, const std::vector<std::string>& cells) {
  for (const std::string& text : cells) {
    out << "| " << text << ' ';
  }
  out << "|\n";
}

std::string pair(const Eigen::Vector2d& value) {
  return cell(value[0]) + " / " + cell(value[1]);
}

void noiseFree(std::ostream& out, const Options& options) {
  out << "Noise-free, |f_u - f_s| in rad/s^2, joint 1 / joint 2\n\n";
  row(out, {"experiment", "rate", "sampler", "mean", "max"});
  row(out, {"---", "---", "---", "---", "---"});
  for (const int number : {1, 2}) {
    for (const double rate_Hz : {500.0, 1000.0, 2000.0, 10000.0}) {
      const auto samples =
          runPaperExperiment(number == 1 ? PaperExperiment::kFirst : PaperExperiment::kSecond, rate_Hz,
                             options.seconds, options.seed);
      for (const Sampler& sampler : kSamplers) {
        const Error error =
            measure(*sampler.make(), samples, {.stamp_mid_step = sampler.averages_over_step}, options.seed);
        row(out, {std::to_string(number), cell(rate_Hz / 1000.0) + " kHz", sampler.name, pair(error.mean),
                  pair(error.maximum)});
      }
    }
  }
}

void noisy(std::ostream& out, const Options& options) {
  out << "\n1 kHz, Gaussian noise of " << kNoise
      << " rad and rad/s, mean |f_u - f_s| in rad/s^2, joint 1 / joint 2\n"
      << "low-pass: second-order Butterworth, " << kCutoff_Hz << " Hz, behind the sampler, causal\n\n";
  row(out, {"experiment", "noise on", "sampler", "raw", "low-pass"});
  row(out, {"---", "---", "---", "---", "---"});
  for (const int number : {1, 2}) {
    const auto samples = runPaperExperiment(number == 1 ? PaperExperiment::kFirst : PaperExperiment::kSecond,
                                            1000.0, options.seconds, options.seed);
    for (const Noise noise : {Noise::kVelocity, Noise::kBothStates}) {
      for (const Sampler& sampler : kSamplers) {
        const Error raw =
            measure(*sampler.make(), samples, {.noise = noise, .stamp_mid_step = sampler.averages_over_step},
                    options.seed);
        const Error filtered =
            measure(*sampler.make(), samples, {.noise = noise, .cutoff_Hz = kCutoff_Hz}, options.seed);
        row(out, {std::to_string(number), noise == Noise::kVelocity ? "velocity" : "both states",
                  sampler.name, pair(raw.mean), pair(filtered.mean)});
      }
    }
  }
}

void report(std::ostream& out, const Options& options) {
  noiseFree(out, options);
  noisy(out, options);
  out << "\nThe printed form chatters: sign(psi) multiplies |f| + delta in (23), and psi, once small, "
         "changes sign from "
         "step to step,\nso that the estimate jumps between about -f - |f| - delta and -f + |f| + delta; "
         "only its running "
         "mean tends to f_u.\nThe implicit form takes f as feed-forward and solves for psi, which becomes "
         "exactly zero; "
         "what remains is the error\nof the trapezoidal rule.\n";
}

}  // namespace

int main(int argc, char** argv) {  // NOLINT(bugprone-exception-escape): ends it, with its text
  Options options;
  CLI::App app("Accuracy of the finite-time sampler in the paper's experiments", "patella-study-sampler");
  app.add_option("--seconds", options.seconds, "length of each experiment, s")
      ->capture_default_str()
      ->check(patella::options::numberFrom(2.0, 1000.0));
  app.add_option("--seed", options.seed, "of torque and noise")->capture_default_str();
  app.add_option("--out", options.out, "write the tables to this file (Markdown) instead of the terminal");
  return patella::options::runProgram(app, argc, argv, [&] {
    if (options.out.empty()) {
      report(std::cout, options);
      return;
    }
    std::ofstream file(options.out);
    report(file, options);
    file.close();
    if (!file) {
      throw std::runtime_error("cannot write " + options.out);
    }
  });
}
