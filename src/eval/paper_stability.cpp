// How stable the missing-data features are as the pose difference grows.
#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "eval/paper_kit.hpp"
#include "fft_icp/missing/from_missing.hpp"

namespace phasescan {

void paper_stability(PaperKit& kit, const PaperPairs& pairs) {
  constexpr double kBin = 0.2;
  constexpr std::size_t kBins = 7;
  struct Cell {
    std::size_t n = 0, large_enough = 0, first_right = 0, accepted = 0, accepted_right = 0;
    std::vector<double> error_at_truth;
  };
  nlohmann::ordered_json json;
  Figure figure;
  figure.cell_width = 400.0;
  figure.cell_height = 300.0;
  figure.shared_legend = false;
  for (const Variant variant : {Variant::kPrinted, Variant::kOurs}) {
    const AnyMatchOptions& options = kit.options_of(variant);
    std::vector<Cell> cells(kBins);
    MissingMatcher matcher;
    PairSource source = simulated_source(pairs.generator, pairs.count, kit.options.threads);
    while (const std::optional<BenchPair> given = source()) {
      const ScanPair& pair = given->pair;
      const double distance = std::hypot(pair.truth->x, pair.truth->y);
      Cell& cell = cells[std::min(kBins - 1, static_cast<std::size_t>(distance / kBin))];
      const MissingFeatures a = missing_features(pair.reference, options), b = missing_features(pair.scan, options);
      ++cell.n;
      const double least = deg_to_rad(options.missing.min_size_deg);
      if (a.size < least || b.size < least) continue;
      ++cell.large_enough;
      cell.error_at_truth.push_back(missing_error(a, b, pair.truth->theta));
      const MissingRotation found = matcher.match(a, b, options.missing);
      const bool right = angle_distance(found.theta, pair.truth->theta) < deg_to_rad(5.0);
      cell.first_right += right;
      cell.accepted += found.accepted;
      cell.accepted_right += found.accepted && right;
    }
    Chart error;
    error.title = fmt::format("Eq. 7 at the true rotation, {}", variant_name(variant));
    error.x.label = "distance between the poses [m]";
    error.x.min = 0.0;
    error.x.max = kBin * static_cast<double>(kBins);
    error.y.label = "e(true rotation)";
    error.y.min = 0.0;
    error.y.max = 1.0;
    Chart share = error;
    share.title = fmt::format("The rotation it gives, {}", variant_name(variant));
    share.y.label = "share [%]";
    share.y.max = 100.0;
    Series band{SeriesKind::kBand, "quartiles", {}, {}}, median{SeriesKind::kLine, "median", {}, {}};
    Series usable{SeriesKind::kLine, "features large enough (of all pairs)", {}, {}};
    Series first{SeriesKind::kLine, "best rotation within 5 deg (of those)", {}, {}};
    Series accepted{SeriesKind::kLine, "accepted (of all pairs)", {}, {}};
    Series kept{SeriesKind::kLine, "accepted ones within 5 deg", {}, {}};
    band.color = median.color = palette::kBlue;
    usable.color = palette::kGrey, first.color = palette::kBlue, accepted.color = palette::kOrange,
    kept.color = palette::kGreen;
    usable.marker = Marker::kDiamond, first.marker = Marker::kCircle, accepted.marker = Marker::kSquare,
    kept.marker = Marker::kTriangle;
    const auto ratio = [](std::size_t a, std::size_t b) {
      return b > 0 ? 100.0 * static_cast<double>(a) / static_cast<double>(b) : std::nan("");
    };
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (std::size_t i = 0; i < kBins; ++i) {
      const Cell& cell = cells[i];
      if (cell.n == 0) continue;
      const double x = (static_cast<double>(i) + 0.5) * kBin;
      if (!cell.error_at_truth.empty()) {
        band.x.push_back(x);
        band.low.push_back(quantile(cell.error_at_truth, 0.25));
        band.high.push_back(quantile(cell.error_at_truth, 0.75));
        median.x.push_back(x);
        median.y.push_back(quantile(cell.error_at_truth, 0.5));
      }
      for (Series* s : {&usable, &first, &accepted, &kept}) s->x.push_back(x);
      usable.y.push_back(ratio(cell.large_enough, cell.n));
      first.y.push_back(ratio(cell.first_right, cell.large_enough));
      accepted.y.push_back(ratio(cell.accepted, cell.n));
      kept.y.push_back(ratio(cell.accepted_right, cell.accepted));
      rows.push_back({{"distance_m", x},
                      {"pairs", cell.n},
                      {"large_enough", cell.large_enough},
                      {"best_within_5_deg", cell.first_right},
                      {"accepted", cell.accepted},
                      {"accepted_within_5_deg", cell.accepted_right},
                      {"median_error_at_truth", quantile(cell.error_at_truth, 0.5)}});
    }
    json[variant == Variant::kPrinted ? "printed" : "defaults"] = rows;
    error.series = {band, median};
    share.series = {usable, first, accepted, kept};
    figure.charts.push_back(std::move(error));
    figure.charts.push_back(std::move(share));
  }
  kit.report.heading("How stable are the missing-data features?");
  kit.report.paragraph(
      "The features are what the sensor does not see, so they change as it moves. Left: the error of Eq. 7 at the true "
      "rotation, which would be 0 if the features only turned. Right: how often the shortcut is offered and how often "
      "it "
      "is right.");
  kit.figure(
      "missing_data_stability", figure.svg(),
      "Missing-data features against the distance between the two poses, all scenes; any rotation in class global.");
  kit.data("missing_data_stability", json);
}

}  // namespace phasescan
