#include "eval/pair_rows.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan {
namespace {

constexpr double kChi2_3_95 = 7.814727903251179;

std::size_t place_of(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

std::size_t method_count(const std::vector<PairOutcome>& outcomes) {
  std::size_t count = 0;
  for (const PairOutcome& o : outcomes) count = std::max(count, o.method + 1);
  return count;
}

/// Outcomes sorted into `cells` boxes; those for which `cell` gives `cells` or more are left out.
template <class Cell>
std::vector<std::vector<const PairOutcome*>> sort_into(const std::vector<PairOutcome>& outcomes, std::size_t cells,
                                                       Cell cell) {
  std::vector<std::vector<const PairOutcome*>> boxes(cells);
  for (const PairOutcome& o : outcomes) {
    const std::size_t at = cell(o);
    if (at < cells) boxes[at].push_back(&o);
  }
  return boxes;
}

double share(std::size_t hits, std::size_t n) {
  return n > 0 ? static_cast<double>(hits) / static_cast<double>(n) : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

std::array<double, 6> step_ms(const MatchTimes& ms) {
  return {ms.total, ms.image, ms.missing, ms.rotation, ms.translation, ms.refine};
}

double BenchRow::success() const {
  return share(right, with_truth);
}

double BenchRow::known_success() const {
  return share(known_right(), known());
}

BenchRow sum_up(std::span<const PairOutcome* const> outcomes) {
  BenchRow row;
  row.n = outcomes.size();
  if (!outcomes.empty()) {
    row.dataset = outcomes.front()->dataset;
    row.cls = outcomes.front()->cls;
    row.method = outcomes.front()->method;
  }
  std::vector<double> x, y, rotation, efficiencies;
  std::vector<Judgement> judgements;
  std::size_t nees_n = 0, nees_inside = 0;
  std::array<std::vector<double>, 6> times;
  for (const PairOutcome* o : outcomes) {
    row.with_truth += o->has_truth;
    row.right += o->right;
    (o->right ? (o->usable ? row.right_usable : row.right_refused)
              : (o->usable ? row.wrong_usable : row.wrong_refused)) += 1;
    row.ambiguous += o->ambiguous;
    if (o->right) {
      x.push_back(std::abs(o->error_x));
      y.push_back(std::abs(o->error_y));
      rotation.push_back(rad_to_deg(std::abs(o->error_theta)));
      row.shortcut_right += o->rotation_source == RotationSource::kMissingData;
    }
    if (is_weak(*o)) {
      ++row.weak;
      row.weak_right += o->right;
      row.weak_ambiguous += o->ambiguous;
      row.weak_across += o->error_across_m < kSuccessTranslation_m;
    } else if (o->right && std::isfinite(o->efficiency)) {
      efficiencies.push_back(o->efficiency / 3.0);
    }
    if (o->confidence) judgements.push_back({*o->confidence, o->right});
    if (o->usable && std::isfinite(o->nees)) {
      ++nees_n;
      nees_inside += o->nees < kChi2_3_95;
    }
    row.rotation_sources[static_cast<std::size_t>(o->rotation_source)] += 1;
    const std::array<double, 6> ms = step_ms(o->ms);
    for (std::size_t s = 0; s < ms.size(); ++s) times[s].push_back(ms[s]);
  }
  row.efficiency = std::sqrt(moments(efficiencies).mean);
  row.interval = wilson_interval(row.right, row.with_truth);
  row.known_interval = wilson_interval(row.known_right(), row.known());
  row.x_m = moments(x);
  row.y_m = moments(y);
  row.rotation_deg = moments(rotation);
  row.with_confidence = judgements.size();
  row.auc = area_under_roc(judgements);
  row.calibration_error = calibration_error(judgements);
  row.nees_below = share(nees_inside, nees_n);
  for (std::size_t s = 0; s < times.size(); ++s) {
    row.times[s] = {moments(times[s]).mean, quantile(times[s], 0.5), quantile(times[s], 0.95),
                    quantile(times[s], 0.99)};
  }
  return row;
}

std::vector<std::string> datasets_in_order(const std::vector<PairOutcome>& outcomes) {
  std::vector<std::string> names;
  for (const PairOutcome& o : outcomes) {
    if (place_of(names, o.dataset) == names.size()) names.push_back(o.dataset);
  }
  return names;
}

std::vector<std::string> classes_in_order(const std::vector<PairOutcome>& outcomes) {
  const std::vector<std::string> known{"small", "middle", "large", "global", kNoneClass};
  std::vector<std::string> seen, names;
  for (const PairOutcome& o : outcomes) {
    if (place_of(seen, o.cls) == seen.size()) seen.push_back(o.cls);
  }
  for (const std::string& name : known) {
    if (place_of(seen, name) < seen.size()) names.push_back(name);
  }
  for (const std::string& name : seen) {
    if (place_of(known, name) == known.size()) names.push_back(name);
  }
  return names;
}

std::vector<BenchRow> pair_rows(const std::vector<PairOutcome>& outcomes) {
  const std::vector<std::string> datasets = datasets_in_order(outcomes), classes = classes_in_order(outcomes);
  const std::size_t methods = method_count(outcomes);
  std::vector<BenchRow> rows;
  for (const auto& box : sort_into(outcomes, datasets.size() * classes.size() * methods, [&](const PairOutcome& o) {
         return (place_of(datasets, o.dataset) * classes.size() + place_of(classes, o.cls)) * methods + o.method;
       })) {
    if (!box.empty()) rows.push_back(sum_up(box));
  }
  return rows;
}

std::vector<BenchRow> pair_totals(const std::vector<PairOutcome>& outcomes) {
  const std::vector<std::string> datasets = datasets_in_order(outcomes), classes = classes_in_order(outcomes);
  const std::size_t methods = method_count(outcomes);
  std::vector<BenchRow> rows;
  const auto add = [&](const std::vector<std::vector<const PairOutcome*>>& boxes, bool all_datasets, bool all_classes) {
    for (const auto& box : boxes) {
      if (box.empty()) continue;
      rows.push_back(sum_up(box));
      if (all_datasets) rows.back().dataset = "all";
      if (all_classes) rows.back().cls = "all";
    }
  };
  add(sort_into(outcomes, datasets.size() * methods,
                [&](const PairOutcome& o) { return place_of(datasets, o.dataset) * methods + o.method; }),
      false, true);
  add(sort_into(outcomes, classes.size() * methods,
                [&](const PairOutcome& o) { return place_of(classes, o.cls) * methods + o.method; }),
      true, false);
  add(sort_into(outcomes, methods, [&](const PairOutcome& o) { return o.method; }), true, true);
  return rows;
}

}  // namespace phasescan
