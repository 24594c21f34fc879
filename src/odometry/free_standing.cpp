#include "odometry/free_standing.hpp"

#include <algorithm>
#include <cmath>

namespace phasescan {
namespace {

// What an object must be to stand free. Chosen on people, chairs and pillars of the recorded corridors.
constexpr float kBehindM = 0.3F;  // [m] between an object and what is behind it
constexpr float kWideM = 0.8F;    // [m] more is a wall or a cupboard
constexpr float kFarM = 4.0F;     // [m] beyond, neighbouring hits of one wall may lie this far apart
constexpr int kMissingBeams = 3;  // a gap of more is a gap between objects
// Where there is little else, free-standing objects are what there is: none is marked.
constexpr float kMostShare = 0.8F;      // of the hits that may be marked
constexpr std::size_t kLeastLeft = 24;  // hits on other surfaces
// Which are static.
constexpr float kSameObjectM = 0.1F;  // [m] hits on one object lie so near to each other
constexpr float kApartM = 0.8F;       // [m] what moves with the robot has moved clear of where it stood

enum class Border { kNone, kFarther, kNearer, kGap };

/// Where a coordinate lies in cells, as std::floor but without a call.
std::int32_t cell_of(float metres) {
  const float cells = metres / kSameObjectM;
  const auto whole = static_cast<std::int32_t>(cells);
  return whole - (cells < static_cast<float>(whole) ? 1 : 0);
}

std::uint32_t bucket_of(std::int32_t u, std::int32_t v) {
  std::uint32_t h = static_cast<std::uint32_t>(u) * 0x9E3779B1U ^ static_cast<std::uint32_t>(v) * 0x85EBCA77U;
  h ^= h >> 15;
  return h;
}

/// The last hit's beam stands next to the first one's.
bool goes_round(const SurfacePoints& surface) {
  const SurfacePoint &a = surface[0], &b = surface[surface.size() - 1];
  const double angle = std::atan2(static_cast<double>(a.y), static_cast<double>(a.x)) -
                       std::atan2(static_cast<double>(b.y), static_cast<double>(b.x));
  return std::abs(wrap_angle(angle)) < 4.0 * surface.spacing;
}

}  // namespace

void mark_free_standing(const SurfacePoints& surface, std::vector<std::uint8_t>& out) {
  const std::size_t n = surface.size();
  out.assign(n, 0);
  if (n < 2) return;
  const bool full_circle = goes_round(surface);
  const auto at = [n](std::size_t i) { return i % n; };
  // What lies between hit i and the one after it.
  const auto border = [&](std::size_t i) {
    const std::size_t a = at(i), b = at(i + 1);
    if (b == 0 && !full_circle) return Border::kGap;
    if (b != 0 && std::abs(surface.beam[b] - surface.beam[a]) > kMissingBeams) return Border::kGap;
    const float off = surface.range[b] - surface.range[a];
    return off > kBehindM ? Border::kFarther : off < -kBehindM ? Border::kNearer : Border::kNone;
  };
  std::size_t start = 0;
  while (start < n && border(start) == Border::kNone) ++start;
  if (start == n) return;  // one closed wall
  ++start;
  Border before = border(start - 1);
  std::size_t marked = 0;
  for (std::size_t first = start; first < start + n;) {
    std::size_t last = first;
    float wide = 0.0F;
    const SurfacePoint& p = surface[at(first)];
    Border after = border(last);
    while (after == Border::kNone) {
      ++last;
      const SurfacePoint& q = surface[at(last)];
      wide = std::max(wide, std::hypot(q.x - p.x, q.y - p.y));
      after = border(last);
    }
    const bool free =
        (before == Border::kNearer || before == Border::kGap) && (after == Border::kFarther || after == Border::kGap);
    if (free && wide < kWideM && surface.range[at(first)] < kFarM) {
      for (std::size_t i = first; i <= last; ++i) out[at(i)] = 1;
      marked += last + 1 - first;
    }
    before = after;
    first = last + 1;
  }
  if (static_cast<float>(marked) > kMostShare * static_cast<float>(n) || n - marked < kLeastLeft) out.assign(n, 0);
}

void StaticObjectFilter::find(const std::vector<FreeStandingHit>& hits, const std::vector<Pose2>& poses,
                              std::vector<std::uint8_t>& out) {
  out.assign(hits.size(), 0);
  std::size_t size = 64;
  while (size < 2 * hits.size()) size *= 2;
  heads_.assign(size, -1);
  next_.resize(hits.size());
  // Hits of one view in one cell stand for each other.
  first_.resize(hits.size());
  cells_.resize(hits.size());
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const Cell cell{cell_of(hits[i].x), cell_of(hits[i].y)};
    cells_[i] = cell;
    std::int32_t& head = heads_[bucket_of(cell.u, cell.v) & (size - 1)];
    first_[i] = static_cast<std::int32_t>(i);
    for (std::int32_t j = head; j >= 0 && hits[static_cast<std::size_t>(j)].view == hits[i].view;
         j = next_[static_cast<std::size_t>(j)]) {
      const Cell& other = cells_[static_cast<std::size_t>(j)];
      if (cell.u != other.u || cell.v != other.v) continue;
      first_[i] = j;
      break;
    }
    if (first_[i] != static_cast<std::int32_t>(i)) continue;
    next_[i] = head;
    head = static_cast<std::int32_t>(i);
  }
  views_.clear();
  for (const Pose2& T : poses)
    views_.push_back({static_cast<float>(std::cos(T.theta)), static_cast<float>(std::sin(T.theta)),
                      static_cast<float>(T.x), static_cast<float>(T.y)});
  const auto squared = [](float x, float y) { return x * x + y * y; };
  const auto meets = [&](const FreeStandingHit& a, const FreeStandingHit& b) {
    if (a.view == b.view || squared(a.x - b.x, a.y - b.y) > kSameObjectM * kSameObjectM) return false;
    const View& v = views_[static_cast<std::size_t>(b.view)];
    return squared(v.cos * a.base_x - v.sin * a.base_y + v.x - a.x, v.sin * a.base_x + v.cos * a.base_y + v.y - a.y) >
           kApartM * kApartM;
  };
  for (std::size_t i = 0; i < hits.size(); ++i) {
    const auto first = static_cast<std::size_t>(first_[i]);
    if (first != i) {
      out[i] = out[first];  // final: its turn was before
      continue;
    }
    for (int k = 0; k < 9 && !out[i]; ++k) {
      const float x = hits[i].x + static_cast<float>(k % 3 - 1) * kSameObjectM,
                  y = hits[i].y + static_cast<float>(k / 3 - 1) * kSameObjectM;
      for (std::int32_t j = heads_[bucket_of(cell_of(x), cell_of(y)) & (size - 1)]; j >= 0;
           j = next_[static_cast<std::size_t>(j)]) {
        if (!meets(hits[i], hits[static_cast<std::size_t>(j)])) continue;
        out[i] = 1;
        break;
      }
    }
  }
}

}  // namespace phasescan
