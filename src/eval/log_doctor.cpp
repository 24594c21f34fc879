#include "eval/log_doctor.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "eval/log_stamps.hpp"
#include "eval/motion_check.hpp"
#include "phasescan/core/pose2.hpp"
#include "odometry/own_body.hpp"

namespace phasescan {
namespace {

/// What is counted of one laser.
struct Laser {
  std::size_t scans = 0, beams = 0, missing = 0, empty = 0;
  std::size_t fewest_beams = 0, most_beams = 0, beams_changed = 0, last_beams = 0;
  std::size_t doubled = 0, same_in_a_row = 0;
  std::size_t without_range_max = 0;
  std::vector<float> sweep_seconds;  ///< beams * time_increment, of the first scans
  double widest_fan = 0.0;           ///< [rad]
  std::uint64_t last_content = 0;
  std::vector<std::uint32_t> hits;  ///< by beam, while the count of beams stays
  StampStatistics stamps;
  MotionCheck motion;
  OwnBody own_body;
  OwnBodyState body;
};

constexpr std::size_t kMostSweeps = 4096;

/// How many of a run of equal scans were sent again.
std::size_t repeats(std::size_t same_in_a_row) {
  constexpr std::size_t kAtRest = 10;
  return same_in_a_row <= kAtRest ? same_in_a_row : 0;
}

double median_of(std::vector<float> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// FNV-1a over the bits of the ranges: equal scans have equal numbers.
std::uint64_t content_of(const Scan& scan) {
  std::uint64_t hash = 14695981039346656037ULL;
  for (std::size_t i = 0; i < scan.size(); ++i) {
    std::uint32_t bits = static_cast<std::uint32_t>(scan.states[i]);
    if (scan.is_hit(i)) std::memcpy(&bits, &scan.ranges[i], sizeof bits);
    hash = (hash ^ bits) * 1099511628211ULL;
  }
  return hash;
}

double percent(std::size_t part, std::size_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

/// The longest run of beams that never hit anything, as a share of all.
std::size_t longest_blind_run(const std::vector<std::uint32_t>& hits) {
  std::size_t run = 0, longest = 0;
  for (const std::uint32_t count : hits) {
    run = count == 0 ? run + 1 : 0;
    longest = std::max(longest, run);
  }
  return longest;
}

void count_scan(Laser& laser, const Scan& scan) {
  const std::size_t n = scan.size();
  const std::size_t hits = scan.hit_count();
  ++laser.scans;
  laser.beams += n;
  laser.missing += n - hits;
  laser.empty += hits == 0 ? 1 : 0;
  laser.fewest_beams = laser.scans == 1 ? n : std::min(laser.fewest_beams, n);
  laser.most_beams = std::max(laser.most_beams, n);
  if (laser.scans > 1 && n != laser.last_beams) ++laser.beams_changed;
  if (laser.hits.size() == n || laser.scans == 1) {
    laser.hits.resize(n);
    for (std::size_t i = 0; i < n; ++i) laser.hits[i] += scan.is_hit(i) ? 1U : 0U;
  }
  laser.last_beams = n;
  const std::uint64_t content = content_of(scan);
  // A few repeats are messages sent again. A long run is a simulated laser at rest: its scans have no noise.
  const bool same = laser.scans > 1 && hits > 0 && content == laser.last_content;
  if (!same) laser.doubled += repeats(laser.same_in_a_row);
  laser.same_in_a_row = same ? laser.same_in_a_row + 1 : 0;
  laser.last_content = content;
  if (scan.geometry.range_max == 0.0) ++laser.without_range_max;
  if (laser.sweep_seconds.size() < kMostSweeps)
    laser.sweep_seconds.push_back(static_cast<float>(scan.time_increment * static_cast<double>(n)));
  if (n > 1) laser.widest_fan = std::max(laser.widest_fan, std::abs(scan.angle(n - 1) - scan.angle(0)));
}

void find_in_scans(const Laser& laser, std::vector<Finding>& out) {
  if (laser.beams_changed > 0) {
    out.push_back({"beams vary",
                   fmt::format("{} to {} beams a scan, changing {} times", laser.fewest_beams, laser.most_beams,
                               laser.beams_changed),
                   "the driver sends what arrived in a turn; many mapping tools refuse such scans, phasescan does not",
                   "nothing for phasescan; for others resample in the driver (angle compensation, fixed count)"});
  }
  if (laser.without_range_max == laser.scans) {
    out.push_back({"range_max unknown", "no scan states a range_max above 0",
                   "a beam without a return cannot be told from one that saw nothing up to its limit",
                   "set range_max in the driver; until then the longest range of a scan stands for it"});
  }
  if (percent(laser.missing, laser.beams) > 50.0) {
    out.push_back({"beams missing",
                   fmt::format("{:.0f} % of all beams have no return", percent(laser.missing, laser.beams)),
                   "open space, glass or black surfaces beyond what the sensor can see; matches rest on few points",
                   "check range_min and range_max and the sensor's window; drive closer to walls"});
  }
  if (laser.empty > 0) {
    out.push_back({"empty scans", fmt::format("{} of {} scans have not one return", laser.empty, laser.scans),
                   "the driver sent a turn before data came, or lost sync",
                   "nothing for phasescan: they are passed over; look at the cable if there are many"});
  }
  const std::size_t blind = longest_blind_run(laser.hits);
  if (laser.scans >= 20 && laser.beams_changed == 0 && 10 * blind > laser.hits.size()) {
    out.push_back({"blind sector",
                   fmt::format("{} neighbouring beams of {} never had a return", blind, laser.hits.size()),
                   "the robot's own body, a mast or a mask of the driver hides part of the view",
                   "normal for a laser behind a body; else move the sensor"});
  }
  if (const std::size_t doubled = laser.doubled + repeats(laser.same_in_a_row); doubled > 0) {
    out.push_back({"scans doubled", fmt::format("{} scans are the same as the one before", doubled),
                   "a recorder or bridge sent a message twice; counted as standing still they falsify the odometry",
                   "record one topic once; check for two publishers"});
  }
}

void find_in_stamps(const Laser& laser, std::vector<Finding>& out) {
  const StampStatistics& stamps = laser.stamps;
  const double median = stamps.median_seconds();
  if (stamps.backwards() > 0) {
    out.push_back(
        {"stamps backwards",
         fmt::format("{} of {} scans are stamped before their predecessor", stamps.backwards(), stamps.count()),
         "speeds come out negative and odometry is looked up at the wrong time",
         "stamp scans where they are measured; check for a clock that was set while recording"});
  }
  if (stamps.repeated() > 0) {
    out.push_back({"stamps repeated", fmt::format("{} scans have the stamp of their predecessor", stamps.repeated()),
                   "no speed can be told between them", "use a clock with a finer step, or the driver's own time"});
  }
  if (median <= 0.0) return;
  const std::size_t bursts = stamps.shorter_than(0.2 * median);
  if (percent(bursts, stamps.count()) > 1.0) {
    out.push_back({"stamps in bursts",
                   fmt::format("{} scans follow within a fifth of the usual {:.3f} s", bursts, median),
                   "scans were stamped when they were received, in heaps, not when they were measured",
                   "stamp in the driver; a slow USB or network link delays messages"});
  }
  const std::size_t gaps = stamps.longer_than(std::max(3.0 * median, median + 0.2));
  if (gaps > 0) {
    out.push_back({"gaps", fmt::format("{} pauses of more than three times the usual {:.3f} s", gaps, median),
                   "the robot moved unseen; the next match has farther to search",
                   "look for lost messages: a full disk, a busy processor, a weak link"});
  }
  // A turn that was lost doubles one distance between stamps and one sweep: the usual ones count.
  const double sweep = median_of(laser.sweep_seconds);
  const double expected = median * std::min(1.0, laser.widest_fan / kTwoPi);
  const bool too_long = sweep > 1.5 * median, too_short = sweep > 0.0 && sweep < expected / 15.0;
  if (too_long || too_short) {
    out.push_back({too_long ? "time_increment absurd" : "time_increment too small",
                   fmt::format("beams take {:.6f} s by time_increment, scans come every {:.3f} s", sweep, median),
                   too_long ? "taking motion out of a scan would bend it"
                            : "motion is left in the scans: time_increment may be in another unit",
                   "set time_increment to the scan time over the number of beams, or to 0"});
  }
}

void find_in_motion(const MotionCounts& motion, std::vector<Finding>& out) {
  if (motion.turns_opposite >= 5 && motion.turns_opposite > 4 * motion.turns_same) {
    out.push_back({"mirrored sensor",
                   fmt::format("in {} of {} turns the scans turn opposite to the odometry", motion.turns_opposite,
                               motion.turns_opposite + motion.turns_same),
                   "the laser is upside down or its angles run clockwise without saying so: the map comes out mirrored",
                   "publish the mounting with roll = pi in /tf_static, or set the driver's `inverted` flag"});
  }
  if (motion.moves_backwards >= 5 && motion.moves_backwards > 4 * motion.moves_same) {
    out.push_back({"mounted backwards",
                   fmt::format("in {} of {} straight runs the scans move opposite to the odometry",
                               motion.moves_backwards, motion.moves_backwards + motion.moves_same),
                   "the laser looks to the rear and the log does not say so: odometry pulls the wrong way",
                   "publish the mounting with yaw = pi in /tf_static"});
  }
  const bool explained =
      motion.turns_opposite > 4 * motion.turns_same || motion.moves_backwards > 4 * motion.moves_same;
  if (!explained && motion.compared >= 10 && percent(motion.disagree, motion.compared) > 25.0) {
    out.push_back({"odometry disagrees",
                   fmt::format("{:.0f} % of {} compared motions differ from what the scans show",
                               percent(motion.disagree, motion.compared), motion.compared),
                   "wheels slip, the ticks, the wheel base or the mounting of the laser are wrong, or stamps lag",
                   "calibrate by a turn on the spot and a straight line; or run with --odometry none"});
  }
  if (motion.neighbours >= 10 && percent(motion.fast, motion.neighbours) > 2.0) {
    out.push_back(
        {"too fast for its rate",
         fmt::format("{} of {} neighbouring scans are more than 20 deg or 0.5 m apart", motion.fast, motion.neighbours),
         "scans overlap less and each one is bent by the motion during its turn",
         "drive or turn slower, or run the sensor faster"});
  }
  if (motion.matched + motion.unmatched >= 20 && motion.unmatched > motion.matched) {
    out.push_back({"scans hard to match",
                   fmt::format("{} of {} pairs of near scans have no match to be trusted", motion.unmatched,
                               motion.matched + motion.unmatched),
                   "corridors, open space, people in front of the sensor, or beams at wrong angles",
                   "check the angles that the driver states; drive where more is to be seen"});
  }
}

/// What a reader's remark means and what to do; the last one speaks for kinds without an entry.
struct RemarkAdvice {
  std::string_view kind, meaning, advice;
};
constexpr RemarkAdvice kAdvice[] = {
    {"angles in degrees", "read as radians the beams would lie all around many times: every wall would be lost",
     "publish radians (REP 103)"},
    {"increment contradicts angle_max", "one of the two is wrong, and with it the direction of every beam",
     "compare a corner of the room with the scan; set angle_increment to (angle_max - angle_min) / (beams - 1)"},
    {"fan beyond a turn", "beams lie on top of each other", "check angle_increment and the number of ranges"},
    {"ranges in millimetres", "read as metres the room would be a thousand times as large", "publish metres (REP 103)"},
    {"several frames", "two drivers, or a driver and a simulation: their scans do not belong to one laser",
     "take one of them with --frame"},
    {"tilted laser", "beams that leave the plane meet floor, ceiling and furniture where no wall is",
     "nothing, if another laser lies in the plane; else mount it level, or --frame NAME"},
    {"stamps all zero", "the recorder's times jitter: speeds and deskewing are less exact",
     "stamp scans in the driver, where they are measured"},
    {"", "the file does not say it: if it is otherwise, the map is bent or mirrored",
     "say it with flags, see `phasescan info --help`"},
};

Finding finding_of(const LogRemark& remark) {
  const auto* advice = std::find_if(std::begin(kAdvice), std::end(kAdvice) - 1,
                                    [&](const RemarkAdvice& known) { return known.kind == remark.kind; });
  return {remark.kind, remark.text, std::string(advice->meaning), std::string(advice->advice)};
}

}  // namespace

struct LogDoctor::Impl {
  std::map<std::string, Laser> lasers;
};

LogDoctor::LogDoctor() : impl_(std::make_unique<Impl>()) {}
LogDoctor::~LogDoctor() = default;

void LogDoctor::add(const LogEntry& entry) {
  constexpr std::size_t kMostLasers = 64;
  if (impl_->lasers.size() >= kMostLasers && !impl_->lasers.contains(entry.laser)) return;
  Laser& laser = impl_->lasers[entry.laser];
  count_scan(laser, entry.scan);
  laser.stamps.add(entry.scan.stamp);
  laser.motion.add(entry);
  laser.own_body.add(entry.scan, laser.body);
}

std::vector<Finding> LogDoctor::findings(const std::map<std::string, std::string>& facts,
                                         const std::vector<LogRemark>& remarks) const {
  std::vector<Finding> out;
  for (const LogRemark& remark : remarks) {
    if (remark.kind != "no scans") out.push_back(finding_of(remark));
  }
  if (const auto absurd = facts.find("time_increment absurd"); absurd != facts.end()) {
    out.push_back({"time_increment absurd", absurd->second,
                   "taking motion out of a scan would bend it: read as unknown",
                   "set time_increment to the scan time over the number of beams, or to 0"});
  }
  for (const auto& [name, laser] : impl_->lasers) {
    const std::size_t before = out.size();
    find_in_scans(laser, out);
    find_in_stamps(laser, out);
    find_in_motion(laser.motion.counts(), out);
    if (!laser.body.sectors.empty()) {
      out.push_back(
          {"own body", "the range in " + format_sectors(laser.body.sectors) + " does not depend on the scene",
           "the robot itself is in the view: it would hold poses and stand in the map wherever it drove; slam leaves it out",
           "--mask FROM:TO leaves it out everywhere"});
    }
    if (impl_->lasers.size() == 1) continue;
    for (std::size_t i = before; i < out.size(); ++i) out[i].seen = name + ": " + out[i].seen;
  }
  return out;
}

}  // namespace phasescan
