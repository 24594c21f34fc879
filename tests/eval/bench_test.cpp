#include "eval/bench.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/random.hpp"
#include "eval/bench_report.hpp"
#include "support/xml_check.hpp"

namespace phasescan::bench_test {
namespace {

/// What a scanner at `pose` sees of a room with a corner cut off, so that no two headings look alike.
Scan look_around(const Pose2& pose, Random& random) {
  const std::vector<Eigen::Vector2d> corners{{-2.5, -1.8}, {2.0, -1.8}, {3.0, -0.6}, {3.0, 2.0}, {-2.5, 1.4}};
  std::vector<float> ranges;
  for (int i = 0; i < 240; ++i) {
    const double angle = -kPi + kTwoPi * i / 240 + pose.theta;
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
    double nearest = 0.0;
    for (std::size_t k = 0; k < corners.size(); ++k) {
      const Eigen::Vector2d a = corners[k] - pose.translation(), e = corners[(k + 1) % corners.size()] - corners[k];
      const double det = e.x() * d.y() - e.y() * d.x();
      if (std::abs(det) < 1e-12) continue;
      const double range = (e.x() * a.y() - e.y() * a.x()) / det, along = (d.x() * a.y() - d.y() * a.x()) / det;
      if (range > 0.0 && along >= 0.0 && along <= 1.0 && (nearest == 0.0 || range < nearest)) nearest = range;
    }
    ranges.push_back(static_cast<float>(nearest + random.normal(0.0, 0.005)));
  }
  return make_scan(ranges, {-kPi, kTwoPi / 240, 0.1, 8.0});
}

std::vector<ScanPair> some_pairs() {
  Random random(11);
  std::vector<ScanPair> pairs;
  for (int i = 0; i < 40; ++i) {
    ScanPair pair;
    pair.id = std::to_string(i);
    pair.dataset = i % 2 ? "odd" : "even";
    pair.cls = i < 20 ? "small" : i < 30 ? "large" : "none";
    const double reach = i < 20 ? 0.1 : 0.6;
    const Pose2 truth{random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
    pair.reference = look_around({}, random);
    pair.scan = look_around(truth, random);
    if (pair.cls != "none") pair.truth = truth;
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

TEST(Bench, OutcomesComePairByPairAndAreTheSameForAnyNumberOfThreads) {
  const std::vector<ScanPair> pairs = some_pairs();
  const std::vector<BenchMethod> methods = bench_methods("icp,fft-icp2", {});
  const BenchInfo info{"1.2.3", {"some pairs"}, false, 1};
  std::string one;
  for (const int threads : {1, 2, 3}) {
    BenchSettings settings;
    settings.threads = threads;
    const BenchRun run = run_bench(pair_source(pairs), methods, settings);
    ASSERT_EQ(run.pairs, 40u);
    ASSERT_EQ(run.outcomes.size(), 80u);
    EXPECT_EQ(run.outcomes[3].method, 1u);
    EXPECT_EQ(run.outcomes[3].dataset, "odd");
    std::string all = bench_json(run, methods, info) + bench_markdown(run, methods, info);
    for (const auto& [name, svg] : bench_figures(run, methods, info)) all += name + svg;
    if (threads == 1) one = all;
    EXPECT_TRUE(all == one) << threads << " threads give other bytes than one";
  }
  EXPECT_EQ(one.find("\"ms\""), std::string::npos);
  EXPECT_EQ(one.find("fft_128"), std::string::npos);
}

TEST(Bench, AVariantIsTheMethodWithOtherOptions) {
  AnyMatchOptions options;
  options.match.method = MatchMethod::kGlobal;
  const BenchMethod variant = bench_variant("no twins, fast : global.twins=false, match.fast = true", options);
  EXPECT_EQ(variant.name, "no twins, fast");
  EXPECT_FALSE(variant.options.global.twins);
  EXPECT_TRUE(variant.options.match.general.fast);
  EXPECT_EQ(variant.options.match.method, MatchMethod::kGlobal);
  EXPECT_TRUE(bench_variant("same:", options).options.global.twins);
  EXPECT_FALSE(bench_variant("earlier name: mh.twins=false", options).options.global.twins);
  for (const char* wrong : {"", "no colon", ": global.twins=false", "x: global.twins", "x: global.nothing=1",
                            "x: global.twins=maybe", "x: twins=false", "x: global.candidates=0"}) {
    EXPECT_THROW(bench_variant(wrong, options), std::invalid_argument) << wrong;
  }
}

TEST(Bench, PreparedReferencesChangeTheTimesAlone) {
  const std::vector<ScanPair> pairs = some_pairs();
  const std::vector<BenchMethod> methods = bench_methods("fft-icp2,global", {});
  BenchSettings prepared;
  prepared.prepared = true;
  prepared.repeat = 2;
  const BenchInfo info{"1.2.3", {"some pairs"}, false, 1};
  const BenchRun raw = run_bench(pair_source(pairs), methods), fast = run_bench(pair_source(pairs), methods, prepared);
  EXPECT_EQ(bench_json(raw, methods, info), bench_json(fast, methods, info));
}

TEST(Bench, FeaturesAreALineForEveryAnswerWithAConfidence) {
  const std::vector<ScanPair> pairs = some_pairs();
  const std::vector<BenchMethod> methods = bench_methods("icp,global", {});
  const std::string csv = bench_features(run_bench(pair_source(pairs), methods), methods);
  EXPECT_EQ(std::count(csv.begin(), csv.end(), '\n'), 1 + static_cast<long>(pairs.size()));
  const std::string header = csv.substr(0, csv.find('\n'));
  std::size_t start = header.size() + 1;
  while (start < csv.size()) {
    const std::string line = csv.substr(start, csv.find('\n', start) - start);
    EXPECT_EQ(std::count(line.begin(), line.end(), ','), std::count(header.begin(), header.end(), ',')) << line;
    start += line.size() + 1;
  }
}

TEST(Bench, JsonHasARowPerDatasetClassAndMethodWithEveryField) {
  const std::vector<ScanPair> pairs = some_pairs();
  const std::vector<BenchMethod> methods = bench_methods("icp,fft-icp2", {});
  const BenchRun run = run_bench(pair_source(pairs), methods);
  EXPECT_GT(run.fft_ms, 0.0);
  const auto json = nlohmann::json::parse(bench_json(run, methods, {"1.2.3", {"some pairs"}, true, 1}));
  EXPECT_EQ(json.at("phasescan"), "1.2.3");
  EXPECT_EQ(json.at("pairs"), 40);
  EXPECT_EQ(json.at("options").at("icp").at("match").at("method"), "icp");
  EXPECT_TRUE(json.at("options").at("fft-icp2").contains("image"));
  ASSERT_EQ(json.at("rows").size(), 2u * 3u * 2u);
  std::size_t counted = 0;
  for (const auto& row : json.at("rows")) {
    counted += row.at("n").get<std::size_t>();
    const auto& honesty = row.at("honesty");
    EXPECT_EQ(honesty.at("right_usable").get<int>() + honesty.at("right_refused").get<int>() +
                  honesty.at("wrong_refused").get<int>() + honesty.at("wrong_usable").get<int>(),
              row.at("n").get<int>());
    if (row.at("class") == "none") {
      EXPECT_TRUE(row.at("success").is_null());
      EXPECT_EQ(honesty.at("right_usable"), 0);
    } else {
      EXPECT_LE(row.at("success").at("low").get<double>(), row.at("success").at("share").get<double>());
      EXPECT_GE(row.at("success").at("high").get<double>(), row.at("success").at("share").get<double>());
    }
    for (const char* axis : {"x_m", "y_m", "rotation_deg"}) {
      for (const char* what : {"mean", "variance", "std", "median"})
        EXPECT_TRUE(row.at("errors").at(axis).contains(what));
    }
    for (const char* step : {"total", "image", "missing", "rotation", "translation", "refine"}) {
      for (const char* what : {"mean", "p50", "p95", "p99"}) EXPECT_TRUE(row.at("ms").at(step).contains(what));
    }
    EXPECT_GT(row.at("ms").at("p50_in_ffts").get<double>(), 0.0);
  }
  EXPECT_EQ(counted, 80u);
  EXPECT_EQ(json.at("totals").back().at("dataset"), "all");
  EXPECT_EQ(json.at("totals").back().at("class"), "all");
}

TEST(Bench, FiguresAreWellFormed) {
  const std::vector<ScanPair> pairs = some_pairs();
  const std::vector<BenchMethod> methods = bench_methods("icp", {});
  BenchRun run = run_bench(pair_source(pairs), methods);
  for (PairOutcome& o : run.outcomes) o.confidence = o.right ? 0.9 : 0.2;
  const auto figures = bench_figures(run, methods, {"1.2.3", {}, true, 1});
  for (const char* name : {"success.svg", "overlap.svg", "errors.svg", "time.svg", "reliability.svg"}) {
    ASSERT_TRUE(figures.contains(name)) << name;
    EXPECT_EQ(xml_error(figures.at(name)), "") << name;
  }
}

TEST(Bench, NoPairsIsAnEmptyTable) {
  const std::vector<BenchMethod> methods = bench_methods("icp", {});
  const BenchRun run = run_bench([]() -> std::optional<BenchPair> { return std::nullopt; }, methods);
  EXPECT_TRUE(run.outcomes.empty());
  EXPECT_TRUE(nlohmann::json::parse(bench_json(run, methods, {})).at("rows").empty());
  EXPECT_TRUE(bench_figures(run, methods, {}).empty());
}

TEST(Bench, DatasetsOfOneNameFromTwoFilesKeepTheirOwnRows) {
  const auto outcome = [](const char* source, const char* dataset) {
    PairOutcome o;
    o.source = source;
    o.dataset = dataset;
    return o;
  };
  std::vector<PairOutcome> outcomes{outcome("intel-180", "intel"), outcome("intel-360", "intel"),
                                    outcome("mixed", "intel"), outcome("mixed", "other"), outcome("lone", "alone")};
  separate_sources(outcomes);
  EXPECT_EQ(outcomes[0].dataset, "intel-180");
  EXPECT_EQ(outcomes[1].dataset, "intel-360");
  EXPECT_EQ(outcomes[2].dataset, "mixed/intel");
  EXPECT_EQ(outcomes[3].dataset, "other");
  EXPECT_EQ(outcomes[4].dataset, "alone");
  EXPECT_EQ(source_name("some/pairs.d/intel-180.jsonl.gz"), "intel-180");
}

TEST(BenchMethods, NamesAreCheckedAndNoneMayComeTwice) {
  EXPECT_EQ(bench_methods("ndt,icp", {}).at(1).options.match.method, MatchMethod::kIcp);
  EXPECT_THROW(bench_methods("icp,icp", {}), std::invalid_argument);
  EXPECT_THROW(bench_methods("icp,", {}), std::invalid_argument);
  EXPECT_THROW(bench_methods("slam", {}), std::invalid_argument);
}

}  // namespace
}  // namespace phasescan::bench_test
