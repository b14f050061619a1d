#include "tools/diagnose/regression/dataset.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "tools/diagnose/regression/resting.hpp"
#include "tools/diagnose/regression/smoothed_series.hpp"
#include "tools/diagnose/thresholds.hpp"
#include "tools/signals/signals.hpp"

namespace patella::diagnose {
namespace {

using offline::Samples;

/// Samples of the band per period of its upper edge; what folds back does so on both sides of the equation.
constexpr double kSamplesPerPeriod = 2.5;
/// Periods of the band's edge that each end of a stretch loses to the filter.
constexpr double kEdgePeriods = 2.0;

// A state that has this torque in place of its own.
model::EffectInput withTorque(const Series& series, std::size_t i, const JointVector& torque_Nm) {
  model::EffectInput input = series.states[i];
  input.torque_Nm = torque_Nm;
  return input;
}

}  // namespace

Dataset::Dataset(std::span<const Recording> recordings, const DatasetOptions& options)
    : joints_(recordings.empty() ? 0 : recordings.front().joints),
      is_static_(!recordings.empty() && recordings.front().is_static) {
  double lowest_rate_Hz = options.evaluation_rate_Hz;
  for (std::size_t r = 0; r < recordings.size(); ++r) {
    const Recording& recording = recordings[r];
    if (recording.joints != joints_ || recording.is_static != is_static_) {
      throw std::invalid_argument(recording.name + ": other joints, or other kind of recording, than " +
                                  recordings.front().name);
    }
    for (const Segment& segment : recording.segments) {
      const double duration_s = static_cast<double>(segment.end - segment.first) / recording.rate_Hz;
      if (is_static_) {
        series_.push_back(restingSeries(recording, segment));
      } else if (duration_s >= readable::kShortest_s) {
        series_.push_back(movingSeries(recording, segment, options));
      } else {
        continue;
      }
      recording_.push_back(r);
      lowest_rate_Hz = std::min(lowest_rate_Hz, series_.back().rate_Hz);
    }
  }
  if (series_.empty()) {
    throw std::invalid_argument("no stretch of at least 2 s without a gap in the recordings");
  }
  if (is_static_) {
    rate_Hz_ = 1.0;
  } else {
    band_Hz_ = std::min(options.band_Hz, readable::kBandShareOfRate * lowest_rate_Hz);
    const double rate_Hz = series_.front().rate_Hz;
    rate_Hz_ = rate_Hz / static_cast<double>(decimation(rate_Hz));
  }
  for (const Series& series : series_) {
    kept_.emplace_back(static_cast<std::size_t>(band(Samples(series.states.size()), series).size()));
    std::iota(kept_.back().begin(), kept_.back().end(), 0);
  }
  countRows();
}

void Dataset::countRows() {
  rows_ = 0;
  blocks_.clear();
  std::vector<double> times_s;
  for (std::size_t s = 0; s < series_.size(); ++s) {
    const std::size_t first = is_static_ ? 0 : firstOf(series_[s]);
    for (std::size_t k = 0; k < kept_[s].size(); ++k, ++rows_) {
      if (k == 0 || kept_[s][k] != kept_[s][k - 1] + 1) {
        blocks_.push_back({.first = rows_, .end = rows_, .recording = recording_[s]});
      }
      ++blocks_.back().end;
      times_s.push_back(
          series_[s]
              .states[first + static_cast<std::size_t>(kept_[s][k]) * decimation(series_[s].rate_Hz)]
              .time_s);
    }
  }
  time_s_ = Eigen::Map<const Eigen::VectorXd>(times_s.data(), rows_);
}

void Dataset::put(const Eigen::VectorXd& banded, std::size_t series, Eigen::Index first,
                  Eigen::Ref<Eigen::VectorXd> column) const {
  column.segment(first, static_cast<Eigen::Index>(kept_[series].size())) = banded(kept_[series]);
}

bool Dataset::leaveOutRest(std::span<const RestingJoint> joints) {
  if (is_static_ || joints.empty()) {
    return false;
  }
  std::vector<std::vector<double>> weights;
  std::vector<std::vector<Eigen::Index>> kept;
  Eigen::Index count = 0;
  for (std::size_t s = 0; s < series_.size(); ++s) {
    weights.push_back(weightsInMotion(series_[s], joints));
    kept.push_back(rowsInMotion(weights.back(), kept_[s], series_[s].rate_Hz,
                                {.first = firstOf(series_[s]), .step = decimation(series_[s].rate_Hz)}));
    count += static_cast<Eigen::Index>(kept.back().size());
  }
  if (static_cast<double>(count) < resting::kLeastLeft * static_cast<double>(rows_)) {
    return false;
  }
  weights_ = std::move(weights);
  kept_ = std::move(kept);
  countRows();
  return true;
}

std::size_t Dataset::edgeSamples(double rate_Hz) const noexcept {
  return static_cast<std::size_t>(kEdgePeriods * rate_Hz / band_Hz_);
}

std::size_t Dataset::firstOf(const Series& series) const noexcept {
  return std::max(series.lead, edgeSamples(series.rate_Hz));
}

std::size_t Dataset::decimation(double rate_Hz) const noexcept {
  return is_static_
             ? 1
             : static_cast<std::size_t>(std::max(1.0, std::floor(rate_Hz / (kSamplesPerPeriod * band_Hz_))));
}

double Dataset::gain(double frequency_Hz) const noexcept {
  if (is_static_) {
    return 1.0;
  }
  // Two passes of the filter, whose edges the bilinear transform bends.
  const double rate_Hz = series_.front().rate_Hz;
  const double one_pass_Hz = offline::onePassCutoff_Hz(band_Hz_, kFilterOrder);
  const double bent = std::tan(std::numbers::pi * frequency_Hz / rate_Hz) /
                      std::tan(std::numbers::pi * one_pass_Hz / rate_Hz);
  return 1.0 / (1.0 + std::pow(bent, 2 * kFilterOrder));
}

Eigen::VectorXd Dataset::band(std::span<const double> signal, const Series& series) const {
  if (is_static_) {
    return Eigen::Map<const Eigen::VectorXd>(signal.data(), static_cast<Eigen::Index>(signal.size()));
  }
  const std::size_t edge = edgeSamples(series.rate_Hz), first = firstOf(series);
  const std::size_t step = decimation(series.rate_Hz);
  const std::size_t count = (signal.size() - first - edge + step - 1) / step;
  Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(count));
  if (std::all_of(signal.begin(), signal.end(), [](double value) { return value == 0.0; })) {
    return result;
  }
  Samples weighed(signal.begin(), signal.end());
  if (!weights_.empty()) {
    const auto& weights = weights_[static_cast<std::size_t>(&series - series_.data())];
    std::transform(weighed.begin(), weighed.end(), weights.begin(), weighed.begin(), std::multiplies<>());
  }
  const Samples filtered = offline::zeroPhaseLowPass(weighed, band_Hz_, series.rate_Hz, kFilterOrder);
  for (std::size_t i = 0; i < count; ++i) {
    result[static_cast<Eigen::Index>(i)] = filtered[first + i * step];
  }
  return result;
}

template <typename Start, typename Torque>
Column Dataset::columnOf(Start start, Torque torque) const {
  Column result(rows_ * joints_);
  Eigen::Index first = 0;
  for (std::size_t s = 0; s < series_.size(); ++s) {
    const Series& series = series_[s];
    std::array<Samples, kMaxJoints> raw;
    for (int joint = 0; joint < joints_; ++joint) {
      raw[static_cast<std::size_t>(joint)].resize(series.states.size());
    }
    start(series);
    for (std::size_t i = 0; i < series.states.size(); ++i) {
      const JointVector value = torque(series, i);
      for (int joint = 0; joint < joints_; ++joint) {
        raw[static_cast<std::size_t>(joint)][i] = value[joint];
      }
    }
    for (int joint = 0; joint < joints_; ++joint) {
      put(band(raw[static_cast<std::size_t>(joint)], series), s, first, result.segment(joint * rows_, rows_));
    }
    first += static_cast<Eigen::Index>(kept_[s].size());
  }
  return result;
}

Column Dataset::column(const std::function<JointVector(const Series&, std::size_t)>& torque) const {
  return columnOf([](const Series&) {}, torque);
}

Column Dataset::jointColumn(int joint,
                            const std::function<double(const Series&, std::size_t)>& torque) const {
  Column result = Column::Zero(rows_ * joints_);
  Eigen::Index first = 0;
  for (std::size_t s = 0; s < series_.size(); ++s) {
    Samples raw(series_[s].states.size());
    for (std::size_t i = 0; i < raw.size(); ++i) {
      raw[i] = torque(series_[s], i);
    }
    put(band(raw, series_[s]), s, first, result.segment(joint * rows_, rows_));
    first += static_cast<Eigen::Index>(kept_[s].size());
  }
  return result;
}

void Dataset::setPredictedTorque(const std::function<JointVector(const Series&, std::size_t)>& torque_Nm) {
  for (Series& series : series_) {
    for (std::size_t i = 0; i < series.states.size(); ++i) {
      series.states[i].torque_Nm = torque_Nm(series, i);
    }
  }
}

void Dataset::askForWholeTorque(int joint) {
  for (Series& series : series_) {
    for (std::size_t i = 0; i < series.states.size(); ++i) {
      series.asked_torque_Nm[i][joint] = series.measured_torque_Nm[i][joint];
    }
  }
}

Column Dataset::driveTorque() const {
  return column([](const Series& series, std::size_t i) { return series.measured_torque_Nm[i]; });
}

Column Dataset::mechanismTorque(const model::Mechanism& body, const JointVector& offset_rad) const {
  return column([&](const Series& series, std::size_t i) -> JointVector {
    const model::EffectInput& state = series.states[i];
    const model::RigidBodyTerms terms = body.rigidBody(state.q + offset_rad, state.dq);
    return terms.inertia * series.acceleration[i] + terms.bias_Nm;
  });
}

Column Dataset::modelTorque(model::DynamicsModel& dynamics) const {
  Column sum = mechanismTorque(dynamics.mechanism(), JointVector::Zero(joints_));
  for (const auto& effect : dynamics.effects()) {
    sum += effectTorque(*effect);
  }
  return sum;
}

template <typename Input>
Column Dataset::ownJointColumn(model::Effect& effect, Input input) const {
  const int joint = effect.joint();
  Column result = Column::Zero(rows_ * joints_);
  Eigen::Index first = 0;
  for (std::size_t s = 0; s < series_.size(); ++s) {
    const Series& series = series_[s];
    Samples raw(series.states.size());
    effect.reset(input(series, 0));
    for (std::size_t i = 0; i < raw.size(); ++i) {
      const model::EffectInput& state = input(series, i);
      if (i > 0) {
        effect.advance(state, 1.0 / series.rate_Hz);
      }
      raw[i] = -effect.torque(state)[joint];
    }
    put(band(raw, series), s, first, result.segment(joint * rows_, rows_));
    first += static_cast<Eigen::Index>(kept_[s].size());
  }
  return result;
}

template <typename Input>
Column Dataset::effectColumn(model::Effect& effect, Input input) const {
  if (!effect.descriptor().has_inertia) {
    return ownJointColumn(effect, input);
  }
  return columnOf([&](const Series& series) { effect.reset(input(series, 0)); },
                  [&](const Series& series, std::size_t i) -> JointVector {
                    const model::EffectInput& state = input(series, i);
                    if (i > 0) {
                      effect.advance(state, 1.0 / series.rate_Hz);
                    }
                    return effect.inertia(state.q) * series.acceleration[i] - effect.torque(state);
                  });
}

Column Dataset::effectTorque(model::Effect& effect) const {
  if (effect.descriptor().of_drive) {
    return effectColumn(effect, [](const Series& series, std::size_t i) {
      return withTorque(series, i, series.measured_torque_Nm[i]);
    });
  }
  return effectColumn(effect, [](const Series& series, std::size_t i) -> const model::EffectInput& {
    return series.states[i];
  });
}

Column Dataset::askedEffectTorque(model::Effect& effect) const {
  return effectColumn(effect, [](const Series& series, std::size_t i) {
    return withTorque(series, i, series.asked_torque_Nm[i]);
  });
}

Eigen::MatrixXd Dataset::regressor(const model::Mechanism& mechanism, const JointVector& offset_rad) const {
  const Eigen::Index parameters = mechanism.baseParameterCount();
  std::vector<Eigen::MatrixXd> all;  // of each series: of each state, one parameter after the other
  for (const Series& series : series_) {
    all.emplace_back(joints_, parameters * static_cast<Eigen::Index>(series.states.size()));
    for (std::size_t i = 0; i < series.states.size(); ++i) {
      const model::EffectInput& state = series.states[i];
      all.back().middleCols(parameters * static_cast<Eigen::Index>(i), parameters) =
          mechanism.regressor(state.q + offset_rad, state.dq, series.acceleration[i]);
    }
  }
  Eigen::MatrixXd columns(rows() * joints(), parameters);
  for (Eigen::Index k = 0; k < parameters; ++k) {
    columns.col(k) = column([&](const Series& series, std::size_t i) -> JointVector {
      const auto number = static_cast<std::size_t>(&series - series_.data());
      return all[number].col(parameters * static_cast<Eigen::Index>(i) + k);
    });
  }
  return columns;
}

Dataset Dataset::changed(const std::function<void(Series&)>& change) const {
  Dataset other = *this;
  for (Series& series : other.series_) {
    change(series);
  }
  return other;
}

Eigen::VectorXd Dataset::variable(const std::function<double(const Series&, std::size_t)>& value) const {
  Eigen::VectorXd result(rows_);
  Eigen::Index first = 0;
  for (std::size_t s = 0; s < series_.size(); ++s) {
    Samples raw(series_[s].states.size());
    for (std::size_t i = 0; i < raw.size(); ++i) {
      raw[i] = value(series_[s], i);
    }
    put(band(raw, series_[s]), s, first, result);
    first += static_cast<Eigen::Index>(kept_[s].size());
  }
  return result;
}

}  // namespace patella::diagnose
