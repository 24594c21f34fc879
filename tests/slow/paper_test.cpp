#include "eval/paper.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/xml_check.hpp"

namespace phasescan::paper_test {
namespace {

TEST(Paper, QuickRunHasEveryFigureAndTableAndTheSameBytesOnOneAndTwoThreads) {
  PaperOptions options;
  options.quick = true;
  options.times = false;
  options.version = "1.2.3";
  const PaperFiles one = run_paper(options);
  options.threads = 2;
  const PaperFiles two = run_paper(options);
  ASSERT_EQ(one.size(), two.size());
  for (const auto& [name, content] : one)
    EXPECT_TRUE(content == two.at(name)) << name << " differs between 1 and 2 threads";

  for (const char* figure : {"fig02_scan_image", "fig03_missing_data", "missing_data_stability", "fig08_steps",
                             "fig09_methods_printed", "fig09_methods_ours", "fig10_success", "fig10_scenes",
                             "fig10_overlap", "fig11_trajectories", "fig11_error_over_time", "fig11_error_by_speed",
                             "fig11_roughness", "fig12_maps_every_scan", "fig12_maps_once_a_second"}) {
    const std::string name = std::string("figures/") + figure + ".svg";
    ASSERT_TRUE(one.contains(name)) << name;
    EXPECT_EQ(xml_error(one.at(name)), "") << name;
  }
  for (const auto& [name, content] : one) {
    if (name.starts_with("data/")) {
      EXPECT_FALSE(nlohmann::json::parse(content).empty()) << name;
    }
  }
  const std::string& report = one.at("report.html");
  EXPECT_EQ(xml_error(report), "");
  for (const char* text : {"Table 2", "as printed", "Large class in the paper", "Fig. 12"}) {
    EXPECT_NE(report.find(text), std::string::npos) << text;
  }
  EXPECT_EQ(report.find("Table 3"), std::string::npos) << "times in a report without times";
}

TEST(Paper, DataSaysWhatTheMethodsReach) {
  PaperOptions options;
  options.quick = true;
  const PaperFiles files = run_paper(options);
  EXPECT_NE(files.at("report.html").find("Table 4"), std::string::npos);
  const auto rows = nlohmann::json::parse(files.at("data/fig10_defaults.json"));
  int n = 0, right = 0;
  for (const auto& row : rows) {
    if (row.at("method") != "fft-icp2") continue;
    n += row.at("n").get<int>();
    right += row.at("success").get<int>();
  }
  EXPECT_GT(n, 200);
  EXPECT_GT(right, n * 9 / 10);
}

}  // namespace
}  // namespace phasescan::paper_test
