#include "sim/revolution.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace phasescan::sim {
namespace {

/// Streams of the effects.
enum Stream : std::uint64_t { kTurn = 1, kJitter, kPhase, kLuck, kSector, kStart, kRate, kBurst };

Random stream_of(std::uint64_t seed, Stream stream, std::uint64_t revolution) {
  return Random(Random::derive(Random::derive(seed, stream), revolution));
}

double either_way(double size, Random& random) {
  return random.chance(0.5) ? size : -size;
}

}  // namespace

std::vector<RevolutionTime> plan_revolutions(const LidarOptions& lidar, double duration_s, std::uint64_t seed) {
  const SensorEffects& effects = lidar.effects;
  const double period = 1.0 / lidar.rate_hz;
  std::vector<RevolutionTime> times;
  const auto steady = static_cast<std::size_t>(std::floor(duration_s * lidar.rate_hz + 1e-9));
  double wander = 0.0, start = 0.0;
  std::uint64_t burst_left = 0;
  const double memory = effects.rate_wander_s > 0.0 ? std::exp(-period / effects.rate_wander_s) : 0.0;
  for (std::uint64_t k = 0;; ++k) {
    RevolutionTime time{static_cast<double>(k) * period, period, false};
    if (effects.rate_wander > 0.0) {
      Random random = stream_of(seed, kRate, k);
      const double fresh = random.normal(0.0, effects.rate_wander);
      wander = k == 0 ? fresh : memory * wander + std::sqrt(1.0 - memory * memory) * fresh;
      time = {start, period * std::max(0.2, 1.0 + wander), false};
      if (start + time.period_s > duration_s + 1e-9 * period) break;
      start += time.period_s;
    } else if (k >= steady) {
      break;
    }
    if (effects.lost_revolutions > 0.0) {
      Random random = stream_of(seed, kBurst, k);
      if (burst_left == 0 && (k == 0 || !times.back().lost) && random.chance(effects.lost_revolutions)) {
        const int sizes = std::max(0, effects.lost_burst_max - effects.lost_burst_min) + 1;
        burst_left =
            static_cast<std::uint64_t>(effects.lost_burst_min) + random.below(static_cast<std::uint64_t>(sizes));
      }
      time.lost = burst_left > 0;
      burst_left -= time.lost ? 1 : 0;
    }
    times.push_back(time);
  }
  return times;
}

RevolutionSource::RevolutionSource(const LidarOptions& lidar, std::uint64_t seed) : lidar_(lidar), seed_(seed) {
  if (lidar_.effects.sample_rate_hz > 0.0) {
    Random random = stream_of(seed_, kPhase, 0);
    next_sample_ = random.uniform(-0.5, 0.5);
  }
}

void RevolutionSource::draw_offsets(Revolution& revolution) {
  const SensorEffects& effects = lidar_.effects;
  const auto beams = static_cast<std::size_t>(lidar_.beams);
  const double step = std::abs(lidar_.angle_increment());
  if (effects.sample_rate_hz > 0.0) {
    // Samples follow each other at the sensor's own rate; the last one that is nearest to a beam stays.
    revolution.offsets.assign(beams, std::numeric_limits<double>::quiet_NaN());
    const double turn = kTwoPi / step, apart = turn / (effects.sample_rate_hz * revolution.period_s);
    for (; next_sample_ < turn - 0.5; next_sample_ += apart) {
      const double beam = std::floor(next_sample_ + 0.5);
      if (beam < static_cast<double>(beams)) revolution.offsets[static_cast<std::size_t>(beam)] = next_sample_ - beam;
    }
    next_sample_ -= turn;
  }
  if (effects.direction_jitter_deg > 0.0) {
    if (revolution.offsets.empty()) revolution.offsets.assign(beams, 0.0);
    Random random = stream_of(seed_, kJitter, count_);
    const double sigma = deg_to_rad(effects.direction_jitter_deg) / step;
    for (double& offset : revolution.offsets) offset += random.normal(0.0, sigma);
  }
}

void RevolutionSource::draw_luck(Revolution& revolution) {
  const SensorEffects& effects = lidar_.effects;
  if (!effects.loses_beams()) return;
  Random random = stream_of(seed_, kLuck, count_);
  const bool first = luck_.empty();
  luck_.resize(static_cast<std::size_t>(lidar_.beams));
  for (double& luck : luck_) {
    const bool kept = random.chance(effects.dropout_memory);
    const double fresh = random.uniform();
    if (first || !kept) luck = fresh;
  }
  revolution.luck = luck_;
}

Revolution RevolutionSource::next(double period_s) {
  const SensorEffects& effects = lidar_.effects;
  Revolution revolution;
  revolution.period_s = period_s;
  if (effects.revolution_turn_deg > 0.0) {
    Random random = stream_of(seed_, kTurn, count_);
    revolution.turn += random.normal(0.0, deg_to_rad(effects.revolution_turn_deg));
  }
  if (effects.wrong_start > 0.0) {
    Random random = stream_of(seed_, kStart, count_);
    if (random.chance(effects.wrong_start)) {
      const double size_deg = random.uniform(effects.wrong_start_min_deg, effects.wrong_start_max_deg);
      revolution.turn += either_way(deg_to_rad(size_deg), random);
    }
  }
  draw_offsets(revolution);
  draw_luck(revolution);
  if (effects.lost_sectors > 0.0) {
    Random random = stream_of(seed_, kSector, count_);
    if (random.chance(effects.lost_sectors)) {
      const double width_deg = random.uniform(effects.lost_sector_min_deg, effects.lost_sector_max_deg);
      const double wide = deg_to_rad(width_deg) / std::abs(lidar_.angle_increment());
      const auto beams = static_cast<std::size_t>(lidar_.beams);
      revolution.gap_size = std::clamp<std::size_t>(static_cast<std::size_t>(wide + 0.5), 1, beams);
      revolution.gap_first = static_cast<std::size_t>(random.below(beams - revolution.gap_size + 1));
    }
  }
  ++count_;
  return revolution;
}

void RevolutionSource::lose_sector(const Revolution& revolution, std::vector<float>& raw) {
  const SectorLoss kind = lidar_.effects.lost_sector_kind;
  if (lidar_.effects.lost_sectors <= 0.0) return;
  std::vector<float> whole = raw;
  if (revolution.gap_size > 0) {
    const auto at = [&](std::size_t i) { return raw.begin() + static_cast<std::ptrdiff_t>(i); };
    const std::size_t end = revolution.gap_first + revolution.gap_size;
    if (kind == SectorLoss::kEmpty) {
      std::fill(at(revolution.gap_first), at(end), 0.0F);
    } else {
      std::copy(at(end), raw.end(), at(revolution.gap_first));
      const std::size_t rest = raw.size() - revolution.gap_size;
      for (std::size_t i = rest; i < raw.size(); ++i)
        raw[i] = kind == SectorLoss::kHeld && i < previous_.size() ? previous_[i] : 0.0F;
    }
  }
  previous_ = std::move(whole);
}

}  // namespace phasescan::sim
