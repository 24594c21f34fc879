#include "phasescan/eval/place_fit.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "phasescan/scan/points.hpp"
#include "phasescan/sim/places.hpp"
#include "slam/place_projection.hpp"

namespace phasescan {
namespace {

constexpr auto kF = static_cast<Eigen::Index>(kPlaceFeatures);
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

/// Second moments of features within and among the places of one kind of building.
struct Scatter {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(kF);
  Eigen::MatrixXd within = Eigen::MatrixXd::Zero(kF, kF), total = Eigen::MatrixXd::Zero(kF, kF);
};

Eigen::VectorXf features_of(PlaceDescriber& describer, const Scan& scan, ScanPoints& points) {
  PlaceFeatures features;
  scan_to_points(scan, points);
  describer.features(points.x, points.y, features);
  return Eigen::Map<const Eigen::VectorXf>(features.data(), kF);
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
      values.col(filled) = features_of(describer, place.scan, points).cast<double>();
      differences.col(filled) = features_of(describer, place.query, points).cast<double>() - values.col(filled);
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
  return out;
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
  }
  double weight = 0.0;
  for (const Kind& kind : kKinds) weight += kind.weight;
  all.mean /= weight;
  // In units of their spread within a place, so that the ridge weighs on all features alike.
  const Eigen::VectorXd spread = all.within.diagonal().cwiseSqrt(), inverse = spread.cwiseInverse();
  all.within = inverse.asDiagonal() * all.within * inverse.asDiagonal();
  all.total = inverse.asDiagonal() * all.total * inverse.asDiagonal();
  all.within.diagonal().array() += kRidge;
  const Eigen::GeneralizedSelfAdjointEigenSolver<Eigen::MatrixXd> solver(all.total, all.within);
  Eigen::VectorXd step(kD);
  std::string rows;
  for (Eigen::Index d = 0; d < kD; ++d) {
    const double signal = std::max(1e-3, solver.eigenvalues()[kF - 1 - d] - 1.0);
    Eigen::VectorXd w = solver.eigenvectors().col(kF - 1 - d);
    w *= std::sqrt(signal / (1.0 + signal));
    step[d] = w.cwiseAbs().maxCoeff() / kMostLetter;
    rows += "    \"";
    for (Eigen::Index f = 0; f < kF; ++f) rows += place_letter(static_cast<int>(std::lround(w[f] / step[d])));
    rows += "\",\n";
  }
  std::string text = fmt::format(
      "// Made by `phasescan bench retrieval --fit FILE --places {} --seed {}`. Of each feature: its mean, its spread within\n"
      "// a place; of each number of a descriptor: its step, and its weights in these steps, a letter a feature.\n",
      places, seed);
  append(text, "kMean", all.mean);
  append(text, "kSpread", spread);
  append(text, "kStep", step);
  return text + "constexpr std::string_view kWeights[] = {\n" + rows + "};\n";
}

}  // namespace phasescan
