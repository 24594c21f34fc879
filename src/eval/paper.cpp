#include "eval/paper.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <stdexcept>

#include "eval/paper_kit.hpp"
#include "phasescan/core/pose2.hpp"
#include "config/config.hpp"
#include "sim/pairs_spec.hpp"
#include "sim/embedded.hpp"

namespace phasescan {
namespace {

AnyMatchOptions strict_options() {
  for (const sim::EmbeddedFile& file : sim::embedded_files()) {
    if (file.name != "paper-strict.yaml") continue;
    Config config;
    option_table(config).load_text(std::string(file.text), std::string(file.name));
    return config.match;
  }
  throw std::logic_error("configs/paper-strict.yaml is not built in");
}

}  // namespace

PaperKit::PaperKit(const PaperOptions& given)
    : options(given),
      printed(strict_options()),
      report("FFT-based scan matching, repeated",
             fmt::format("phasescan {}, seed {}{}. Every experiment of Jiang, Yin, Liu, Xi and Ou, FFT-Based "
                         "Scan-Matching for SLAM "
                         "Applications with Low-Cost Laser Range Finders, Appl. Sci. 2019, 9(1), 41, on simulated "
                         "RPLidar A1 data: "
                         "the methods as printed, and with this project's defaults.",
                         given.version, given.seed, given.quick ? ", quick run" : "")) {}

void PaperKit::figure(const std::string& name, const std::string& svg, const std::string& caption) {
  files["figures/" + name + ".svg"] = svg;
  report.figure(svg, caption);
}

void PaperKit::data(const std::string& name, const nlohmann::ordered_json& json) {
  files["data/" + name + ".json"] = json.dump(1) + "\n";
}

AnyMatchOptions PaperKit::method(Variant variant, MatchMethod method) const {
  AnyMatchOptions out = options_of(variant);
  out.match.method = method;
  return out;
}

std::vector<BenchMethod> PaperKit::methods(Variant variant) const {
  return bench_methods(
      variant == Variant::kPrinted ? "icp,ndt,fft,fft-icp1,fft-icp2" : "icp,ndt,fft,fft-icp1,fft-icp2,global",
      options_of(variant));
}

PaperPairs paper_pairs(const PaperOptions& options) {
  sim::PairsSpec spec = sim::read_pairs_spec("bench-sim");
  std::erase_if(spec.rows, [](const sim::PairRow& row) { return row.sensor != "rplidar-a1"; });
  const std::size_t per_scene_and_class = options.quick ? 15 : 120;
  std::size_t sets = 0;
  for (const sim::PairRow& row : spec.rows) sets += row.classes.size();
  return {std::make_shared<const sim::PairGenerator>(spec, options.seed), sets * per_scene_and_class};
}

MissingFeatures missing_features(const Scan& scan, const AnyMatchOptions& options) {
  MissingFinder finder;
  MissingFeatures out;
  finder.find(scan, options.missing.beyond_dmax ? options.image.dmax_m : 0.0, deg_to_rad(options.missing.min_width_deg),
              out);
  return out;
}

PaperFiles run_paper(const PaperOptions& options, const std::function<void(std::string_view)>& progress) {
  const auto begin = [&](std::string_view part) {
    if (progress) progress(part);
  };
  for (const std::string& path : options.pairs) {  // a bad line now, not after minutes of work
    const PairSource source = file_source(path);
    while (source()) {
    }
  }
  PaperKit kit(options);
  const PaperPairs pairs = paper_pairs(options);
  kit.report.bullets(
      {"As printed: configs/paper-strict.yaml. Where the paper is silent (twin at 180 degrees, peak interpolation, "
       "NDT's "
       "settings) docs/fft_icp.md says what was chosen.",
       "This project's defaults: the same methods with the choices that work best; global is this project's own "
       "matcher.",
       "The paper used a real robot and hand-measured poses; here the scenes are simulated and the truth is exact."});
  begin("images and missing data (Fig. 2, 3)");
  paper_images(kit, pairs);
  begin("stability of the missing-data features");
  paper_stability(kit, pairs);
  begin("one pair, step by step and method by method (Fig. 8, 9)");
  paper_steps(kit, pairs);
  begin("success, accuracy, time (Fig. 10, Tables 2-4)");
  paper_success(kit, pairs);
  begin("dynamic localisation (Fig. 11)");
  paper_drive(kit);
  begin("maps straight from scans (Fig. 12)");
  paper_maps(kit);
  kit.files["report.html"] = kit.report.str();
  return std::move(kit.files);
}

}  // namespace phasescan
