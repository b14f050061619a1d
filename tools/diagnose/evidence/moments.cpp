#include "tools/diagnose/evidence/moments.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "tools/diagnose/regression/cosine_transform.hpp"

namespace patella::diagnose::evidence {
namespace {

/// A band has to tell its level from its own coefficients.
constexpr double kFewestInBand = 6.0;
constexpr double kLowestEdge_Hz = 0.25;

}  // namespace

Moments::Moments(const Dataset& data) : data_(&data) {
  layOut();
}

void Moments::layOut() {
  // Octaves, wider where an octave holds too few coefficients.
  std::vector<double> frequency_Hz;
  for (const Block& block : data_->blocks()) {
    const auto length = static_cast<double>(block.end - block.first);
    for (Eigen::Index k = 0; k < block.end - block.first; ++k) {
      frequency_Hz.push_back(data_->isStatic() ? 0.0
                                               : 0.5 * data_->rate_Hz() * static_cast<double>(k) / length);
    }
  }
  const double highest_Hz = data_->isStatic() ? 1.0 : data_->band_Hz();
  const auto within = [&](double low, double high) {
    return static_cast<double>(std::count_if(frequency_Hz.begin(), frequency_Hz.end(),
                                             [=](double f) { return f >= low && f < high; }));
  };
  edges_Hz_ = {0.0};
  for (double edge = kLowestEdge_Hz; edge < highest_Hz; edge *= 2.0) {
    if (within(edges_Hz_.back(), edge) >= kFewestInBand && within(edge, highest_Hz) >= kFewestInBand) {
      edges_Hz_.push_back(edge);
    }
  }
  edges_Hz_.push_back(highest_Hz);
  place_.assign(frequency_Hz.size(), -1);
  first_.clear();
  Eigen::Index next = 0;
  std::vector<double> counts;
  for (int b = 0; b < bands(); ++b) {
    first_.push_back(next);
    for (std::size_t i = 0; i < place_.size(); ++i) {
      if (frequency_Hz[i] >= edges_Hz_[static_cast<std::size_t>(b)] &&
          frequency_Hz[i] < edges_Hz_[static_cast<std::size_t>(b) + 1]) {
        place_[i] = next++;
      }
    }
    counts.push_back(static_cast<double>(next - first_.back()));
  }
  first_.push_back(next);
  count_.assign(static_cast<std::size_t>(data_->joints()), counts);
  spectra_.assign(count_.size(), Eigen::MatrixXd(next, 0));
  products_.assign(count_.size() * static_cast<std::size_t>(bands()), Eigen::MatrixXd(0, 0));
}

void Moments::reserve(Eigen::Index columns) {
  if (columns <= spectra_.front().cols()) {
    return;
  }
  const Eigen::Index room = std::max<Eigen::Index>(columns, spectra_.front().cols() * 3 / 2);
  for (Eigen::MatrixXd& spectrum : spectra_) {
    spectrum.conservativeResize(Eigen::NoChange, room);
  }
  for (Eigen::MatrixXd& product : products_) {
    product.conservativeResize(room, room);
  }
}

Eigen::Index Moments::append(const Eigen::Ref<const Eigen::MatrixXd>& columns) {
  const Eigen::Index first = columns_;
  const Eigen::Index added = columns.cols();
  reserve(first + added);
  columns_ += added;
  std::size_t at = 0;
  for (const Block& block : data_->blocks()) {
    const Eigen::Index length = block.end - block.first;
    CosineTransform transform(length);
    for (int joint = 0; joint < joints(); ++joint) {
      Eigen::MatrixXd& spectrum = spectra_[static_cast<std::size_t>(joint)];
      for (Eigen::Index c = 0; c < added; ++c) {
        const Eigen::VectorXd& values =
            transform.of(columns.col(c).segment(joint * data_->rows() + block.first, length));
        for (Eigen::Index k = 0; k < length; ++k) {
          const Eigen::Index place = place_[at + static_cast<std::size_t>(k)];
          if (place >= 0) {
            spectrum(place, first + c) = values[k];
          }
        }
      }
    }
    at += static_cast<std::size_t>(length);
  }
  for (int joint = 0; joint < joints(); ++joint) {
    const Eigen::MatrixXd& spectrum = spectra_[static_cast<std::size_t>(joint)];
    for (int b = 0; b < bands(); ++b) {
      const Eigen::Index start = first_[static_cast<std::size_t>(b)];
      const Eigen::Index rows = first_[static_cast<std::size_t>(b) + 1] - start;
      Eigen::MatrixXd& product = products_[index(joint, b)];
      const auto fresh = spectrum.block(start, first, rows, added);
      product.block(0, first, columns_, added).noalias() =
          spectrum.block(start, 0, rows, columns_).transpose() * fresh;
      product.block(first, 0, added, first) = product.block(0, first, first, added).transpose();
    }
  }
  return first;
}

double Moments::coefficients() const noexcept {
  return std::max(std::accumulate(count_.front().begin(), count_.front().end(), 0.0), 1.0);
}

double Moments::square(int joint, Eigen::Index column) const {
  double sum = 0.0;
  for (int b = 0; b < bands(); ++b) {
    sum += products_[index(joint, b)](column, column);
  }
  return sum;
}

}  // namespace patella::diagnose::evidence
