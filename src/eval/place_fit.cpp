#include "eval/place_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <stdexcept>

#include "scan/points.hpp"
#include "sim/places.hpp"
#include "slam/place_projection.hpp"

namespace phasescan {
namespace {

constexpr auto kF = static_cast<Eigen::Index>(kPlaceFeatures);
constexpr auto kR = static_cast<Eigen::Index>(kPlaceRings);
constexpr auto kD = static_cast<Eigen::Index>(kDescriptorSize);
constexpr double kRidge = 0.01;  // of the variance within a place
constexpr std::size_t kPairsAtOnce = 512;

struct Kind {
  sim::WorldKind world;
  double weight;
};
constexpr Kind kKinds[] = {{sim::WorldKind::kFlat, 0.5},
                           {sim::WorldKind::kOffice, 0.17},
                           {sim::WorldKind::kCorridor, 0.17},
                           {sim::WorldKind::kBuilding, 0.17}};

/// The rings of one harmonic. Over all headings their mean is 0.
struct TurningScatter {
  Eigen::MatrixXcd within = Eigen::MatrixXcd::Zero(kR, kR), total = Eigen::MatrixXcd::Zero(kR, kR);
};

/// Second moments of features within and among the places of one kind of building: of their magnitudes, and of the
/// features as a robot with heading 0 would see them.
struct Scatter {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(kF);
  Eigen::MatrixXd within = Eigen::MatrixXd::Zero(kF, kF), total = Eigen::MatrixXd::Zero(kF, kF);
  std::array<TurningScatter, kTurningHarmonics> turning;
};

PlaceFeatures features_of(PlaceDescriber& describer, const Scan& scan, ScanPoints& points) {
  PlaceFeatures features;
  scan_to_points(scan, points);
  describer.features(points.x, points.y, features);
  return features;
}

Eigen::VectorXd magnitudes(const PlaceFeatures& features) {
  const PlaceMagnitudes values = magnitudes_of(features);
  return Eigen::Map<const Eigen::VectorXf>(values.data(), kF).cast<double>();
}

/// Harmonic h of all rings, turned to heading 0.
Eigen::VectorXcd rings(const PlaceFeatures& features, std::size_t h, double theta) {
  Eigen::VectorXcd out(kR);
  for (Eigen::Index r = 0; r < kR; ++r) out[r] = features[static_cast<std::size_t>(r) * kPlaceHarmonics + h];
  return out * std::polar(1.0, 2.0 * static_cast<double>(h) * theta);
}

Scatter scatter_of(sim::WorldKind world, std::uint64_t seed, std::size_t places,
                   const std::function<void(std::size_t)>& progress) {
  sim::PlacesOptions options;
  options.world = world;
  PlaceDescriber describer;
  ScanPoints points;
  Scatter out;
  Eigen::MatrixXd differences(kF, kPairsAtOnce), values(kF, kPairsAtOnce);
  std::size_t n = 0;
  Eigen::Index filled = 0;
  const auto take_in = [&] {
    out.within.selfadjointView<Eigen::Lower>().rankUpdate(differences.leftCols(filled));
    out.total.selfadjointView<Eigen::Lower>().rankUpdate(values.leftCols(filled));
    out.mean += values.leftCols(filled).rowwise().sum();
    filled = 0;
  };
  for (std::uint64_t building = 0; n < places; ++building) {
    for (const sim::Place& place : sim::make_places(options, {}, seed, building)) {
      if (n >= places) break;
      const PlaceFeatures here = features_of(describer, place.scan, points);
      const PlaceFeatures beside = features_of(describer, place.query, points);
      values.col(filled) = magnitudes(here);
      differences.col(filled) = magnitudes(beside) - values.col(filled);
      for (std::size_t h = 0; h < kTurningHarmonics; ++h) {
        const Eigen::VectorXcd value = rings(here, h + 1, place.T_world_place.theta);
        const Eigen::VectorXcd difference = rings(beside, h + 1, place.T_world_query.theta) - value;
        out.turning[h].total += value * value.adjoint();
        out.turning[h].within += difference * difference.adjoint();
      }
      ++n;
      if (++filled == static_cast<Eigen::Index>(kPairsAtOnce)) take_in();
      if (progress) progress(n);
    }
  }
  take_in();
  const auto count = static_cast<double>(n);
  out.mean /= count;
  out.within = out.within.selfadjointView<Eigen::Lower>();
  out.total = out.total.selfadjointView<Eigen::Lower>();
  out.within *= 0.5 / count;  // a difference holds the noise of two views
  out.total = out.total / count - out.mean * out.mean.transpose();
  for (TurningScatter& turning : out.turning) {
    turning.within *= 0.5 / count;
    turning.total /= count;
  }
  return out;
}

/// Directions in which places differ most, best first, in units of the features' spread within a place, so that the
/// ridge weighs on all features alike.
template <class Matrix>
struct Discriminant {
  Eigen::VectorXd spread, step;
  Matrix weights;  ///< of feature and direction, in steps

  Discriminant(const Matrix& within, const Matrix& total, Eigen::Index directions)
      : spread(within.diagonal().real().cwiseSqrt()), step(directions), weights(within.rows(), directions) {
    const Eigen::VectorXd inverse = spread.cwiseInverse();
    Matrix noise = inverse.asDiagonal() * within * inverse.asDiagonal();
    noise.diagonal().array() += kRidge;
    const Matrix all = inverse.asDiagonal() * total * inverse.asDiagonal();
    const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix> solver(all, noise);
    const Eigen::Index last = within.rows() - 1;
    for (Eigen::Index d = 0; d < directions; ++d) {
      const double signal = std::max(1e-3, solver.eigenvalues()[last - d] - 1.0);
      weights.col(d) = solver.eigenvectors().col(last - d) * std::sqrt(signal / (1.0 + signal));
      step[d] = weights.col(d).cwiseAbs().maxCoeff() / kMostLetter;
      weights.col(d) /= step[d];
    }
  }
};

char letter(double steps) {
  return place_letter(static_cast<int>(std::lround(steps)));
}

void append(std::string& text, std::string_view name, const Eigen::VectorXd& values) {
  text += fmt::format("constexpr float {}[] = {{", name);
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    text += fmt::format("{}{:.4e}F,", i % 10 == 0 ? "\n    " : " ", values[i]);
  }
  text += "\n};\n";
}

}  // namespace

std::string fit_place_projection(std::uint64_t seed, std::size_t places,
                                 const std::function<void(std::size_t)>& progress) {
  if (places < 2 * kPlaceFeatures) throw std::invalid_argument("places: too few to fit a projection to");
  Scatter all;
  std::size_t done = 0;
  for (const Kind& kind : kKinds) {
    const Scatter one = scatter_of(kind.world, seed, places, [&](std::size_t n) {
      if (progress) progress(done + n);
    });
    done += places;
    all.mean += kind.weight * one.mean;
    all.within += kind.weight * one.within;
    all.total += kind.weight * one.total;
    for (std::size_t h = 0; h < kTurningHarmonics; ++h) {
      all.turning[h].within += kind.weight * one.turning[h].within;
      all.turning[h].total += kind.weight * one.turning[h].total;
    }
  }
  double weight = 0.0;
  for (const Kind& kind : kKinds) weight += kind.weight;
  all.mean /= weight;
  const Discriminant<Eigen::MatrixXd> unturned(all.within, all.total, kD);
  std::string rows;
  for (Eigen::Index d = 0; d < kD; ++d) {
    rows += "    \"";
    for (Eigen::Index f = 0; f < kF; ++f) rows += letter(unturned.weights(f, d));
    rows += "\",\n";
  }
  constexpr auto kK = static_cast<Eigen::Index>(kTurningNumbers);
  Eigen::VectorXd turning_step(kTurningSize), turning_spread(kTurningHarmonics * kPlaceRings);
  std::string turning_rows;
  for (std::size_t h = 0; h < kTurningHarmonics; ++h) {
    const Discriminant<Eigen::MatrixXcd> turning(all.turning[h].within, all.turning[h].total, kK);
    const auto at = static_cast<Eigen::Index>(h);
    turning_step.segment(at * kK, kK) = turning.step;
    turning_spread.segment(at * kR, kR) = turning.spread;
    for (Eigen::Index d = 0; d < kK; ++d) {
      turning_rows += "    \"";
      for (Eigen::Index r = 0; r < kR; ++r) {
        turning_rows += letter(turning.weights(r, d).real());
        turning_rows += letter(turning.weights(r, d).imag());
      }
      turning_rows += "\",\n";
    }
  }
  std::string text = fmt::format(
      "// Made by `phasescan bench retrieval --fit FILE --places {} --seed {}`. Of each magnitude: its mean, its spread within\n"
      "// a place; of each number of a descriptor: its step, and its weights in these steps, a letter a feature. Of each\n"
      "// harmonic and ring: the spread; of each turning number: its step, and of each ring the weight's two parts.\n",
      places, seed);
  append(text, "kMean", all.mean);
  append(text, "kSpread", unturned.spread);
  append(text, "kStep", unturned.step);
  append(text, "kTurningSpread", turning_spread);
  append(text, "kTurningStep", turning_step);
  text += "constexpr std::string_view kWeights[] = {\n" + rows + "};\n";
  return text + "constexpr std::string_view kTurningWeights[] = {\n" + turning_rows + "};\n";
}

}  // namespace phasescan
