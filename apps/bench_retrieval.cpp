// phasescan bench retrieval: how often the index finds the place again, how fast, and what the matcher makes of its
// answers.
#include <fmt/format.h>

#include <algorithm>

#include "command_list.hpp"
#include "commands.hpp"
#include "phasescan/core/time.hpp"
#include "eval/place_fit.hpp"
#include "io/file.hpp"
#include "methods/any_matcher.hpp"
#include "scan/points.hpp"
#include "sim/places.hpp"
#include "slam/place_check.hpp"
#include "slam/place_index.hpp"

namespace phasescan::app {
namespace {

struct RetrievalFlags {
  CommonFlags common;
  std::size_t places = 1000, queries = 2000, verify = 200;
  std::string fit;
};

/// Where a place or a query is: poses of different buildings have nothing in common.
struct Whereabouts {
  std::uint64_t building = 0;
  Pose2 T_world_sensor;
};

struct Query {
  PlaceDescriptor descriptor;
  std::vector<std::size_t> right;  ///< places within a metre in line of sight
  Scan scan;
  Whereabouts at;
};

int run_fit(const RetrievalFlags& flags) {
  AtomicFile file(flags.fit);  // before the work, so that a name that cannot be written costs no minutes
  Progress progress("places", 4 * flags.places);
  file.write(
      fit_place_projection(flags.common.seed, flags.places, [&progress](std::size_t done) { progress.step(done); }));
  file.commit();
  return kDone;
}

int run_retrieval(const RetrievalFlags& flags) {
  if (!flags.fit.empty()) return run_fit(flags);
  const sim::PlacesOptions options;
  const sim::LidarOptions lidar;
  PlaceDescriber describer;
  PlaceIndex index;
  ScanPoints points;
  std::vector<Query> queries;
  std::vector<Scan> scans;  // kept where the matcher is to be asked
  std::vector<Whereabouts> places;
  const std::size_t stride = std::max<std::size_t>(1, flags.places / std::max<std::size_t>(flags.queries, 1));
  const bool keep = flags.verify > 0;
  double describe_s = 0.0;
  Progress progress("places", flags.places);
  for (std::uint64_t building = 0; index.size() < flags.places; ++building) {
    const std::size_t first_of_building = index.size();
    for (const sim::Place& place : sim::make_places(options, lidar, flags.common.seed, building)) {
      if (index.size() >= flags.places) break;
      const std::size_t k = index.size();
      scan_to_points(place.scan, points);
      const double start = thread_cpu_seconds();
      index.add(describer.describe(points.x, points.y));
      describe_s += thread_cpu_seconds() - start;
      if (keep) scans.push_back(place.scan);
      places.push_back({place.building, place.T_world_place});
      if (k % stride != 0) continue;
      scan_to_points(place.query, points);
      Query query{describer.describe(points.x, points.y), {}, place.query, {place.building, place.T_world_query}};
      for (const std::uint32_t other : place.in_reach) query.right.push_back(first_of_building + other);
      queries.push_back(std::move(query));
    }
    progress.step(index.size());
  }
  std::size_t first = 0, among_ten = 0, asked = 0, found = 0, wrong = 0;
  std::vector<double> query_us;
  AnyMatcher matcher(config_from(flags.common).match);
  const std::size_t verify_stride = std::max<std::size_t>(1, queries.size() / std::max<std::size_t>(flags.verify, 1));
  for (std::size_t q = 0; q < queries.size(); ++q) {
    const double start = thread_cpu_seconds();
    const std::vector<PlaceHit> hits = index.most_alike(queries[q].descriptor, 10);
    query_us.push_back(1e6 * (thread_cpu_seconds() - start));
    bool there = false;
    for (std::size_t r = 0; r < hits.size(); ++r) {
      const auto& rights = queries[q].right;
      const bool right = std::find(rights.begin(), rights.end(), hits[r].place) != rights.end();
      first += r == 0 && right;
      there = there || right;
    }
    among_ten += there;
    if (!keep || q % verify_stride != 0) continue;
    // The most confident of the answers that hold is the one that would be believed.
    ++asked;
    double best = 0.0;
    bool right = false;
    for (const PlaceHit& hit : hits) {
      const MatchResult match = matcher.match(scans[hit.place], queries[q].scan);
      if (!is_same_place(match) || match.confidence.value_or(1.0) <= best) continue;
      best = match.confidence.value_or(1.0);
      // Places of one building overlap: an answer is right where it says truly how the query stands to the place.
      const Whereabouts& place = places[hit.place];
      const Pose2 off = queries[q].at.T_world_sensor.inverse() * place.T_world_sensor * match.T_ref_scan;
      right = place.building == queries[q].at.building && std::hypot(off.x, off.y) < 0.1 &&
              std::abs(off.theta) < deg_to_rad(3.0);
    }
    found += best > 0.0 && right;
    wrong += best > 0.0 && !right;
  }
  const auto n = static_cast<double>(queries.size());
  std::string line = fmt::format(
      "{{\"places\": {}, \"queries\": {}, \"recall_at_1\": {:.4f}, \"recall_at_10\": {:.4f}, \"verified\": {}, \"verified_found\": {}, \"verified_wrong\": {}",
      index.size(), queries.size(), static_cast<double>(first) / n, static_cast<double>(among_ten) / n, asked, found,
      wrong);
  if (!flags.common.no_times) {
    std::nth_element(query_us.begin(), query_us.begin() + static_cast<std::ptrdiff_t>(query_us.size() / 2),
                     query_us.end());
    line += fmt::format(", \"query_us_p50\": {:.1f}, \"describe_us\": {:.1f}", query_us[query_us.size() / 2],
                        1e6 * describe_s / static_cast<double>(index.size()));
  }
  print(line + "}\n");
  return kDone;
}

}  // namespace

void add_retrieval_command(CLI::App& app, CommandBody& body) {
  auto* bench = app.get_subcommand("bench");
  bench->require_subcommand(0, 1);
  auto* command = bench->add_subcommand(
      "retrieval", "place search among simulated places: recall, time, and the matcher's verdict on the answers");
  auto flags = std::make_shared<RetrievalFlags>();
  command->add_option("--places", flags->places, "places in the index")
      ->type_name("N")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  command->add_option("--queries", flags->queries, "about so many of the places are asked for")
      ->type_name("N")
      ->check(CLI::Range(1, 10'000'000))
      ->capture_default_str();
  command->add_option("--verify", flags->verify, "queries whose ten answers the matcher checks; 0: none")
      ->type_name("N")
      ->check(CLI::Range(0, 10'000'000))
      ->capture_default_str();
  command
      ->add_option(
          "--fit", flags->fit,
          "fit the projection of descriptors to N places of each of four kinds of building instead, and write it to FILE")
      ->type_name("FILE");
  add_seed_flag(*command, flags->common);
  add_config_flag(*command, flags->common);
  add_no_times_flag(*command, flags->common);
  command->footer("Example:\n  phasescan bench retrieval --places 1000");
  command->callback([flags, &body] { body = [flags] { return run_retrieval(*flags); }; });
}

}  // namespace phasescan::app
