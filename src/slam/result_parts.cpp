#include "slam/result_parts.hpp"

#include <algorithm>
#include <numeric>

#include "slam/finished_map.hpp"

namespace phasescan {
namespace {

/// Of each session the first one that it hangs together with, through whatever others.
std::vector<int> first_of_group(const Backend& backend, std::size_t sessions) {
  const MapPieces pieces = backend.pieces();
  std::vector<int> first(sessions), of_piece(static_cast<std::size_t>(pieces.count), -1);
  std::iota(first.begin(), first.end(), 0);
  for (std::size_t i = 0; i < pieces.of_node.size(); ++i) {
    const int session = first[static_cast<std::size_t>(backend.keyframes()[i].session)];
    int& known = of_piece[static_cast<std::size_t>(pieces.of_node[i])];
    if (known < 0) known = session;
    const int a = std::min(first[static_cast<std::size_t>(known)], session),
              b = std::max(first[static_cast<std::size_t>(known)], session);
    std::replace(first.begin(), first.end(), b, a);
  }
  return first;
}

/// The groups' first sessions, the one with most keyframes first, of equals the earlier one.
std::vector<int> groups_by_size(const Backend& backend, const std::vector<int>& first_of) {
  std::vector<int> groups, keyframes(first_of.size(), 0);
  for (const Keyframe& k : backend.keyframes())
    ++keyframes[static_cast<std::size_t>(first_of[static_cast<std::size_t>(k.session)])];
  for (int s = 0; s < static_cast<int>(first_of.size()); ++s) {
    if (first_of[static_cast<std::size_t>(s)] == s) groups.push_back(s);
  }
  std::stable_sort(groups.begin(), groups.end(), [&](int a, int b) {
    return keyframes[static_cast<std::size_t>(a)] > keyframes[static_cast<std::size_t>(b)];
  });
  return groups;
}

/// Keyframes of a group that are drawn: those of its largest piece, or all.
std::vector<char> drawn_of(const Backend& backend, const std::vector<char>& in_group, bool largest_alone) {
  const MapPieces pieces = backend.pieces();
  std::vector<int> size(static_cast<std::size_t>(pieces.count), 0);
  for (std::size_t i = 0; i < in_group.size(); ++i) size[static_cast<std::size_t>(pieces.of_node[i])] += in_group[i];
  const auto largest = static_cast<int>(std::max_element(size.begin(), size.end()) - size.begin());
  std::vector<char> drawn = in_group;
  for (std::size_t i = 0; i < drawn.size() && largest_alone; ++i)
    drawn[i] = static_cast<char>(in_group[i] && pieces.of_node[i] == largest);
  return drawn;
}

/// Keyframes and edges of the group alone, numbered anew, in the frame of the part.
void take_graph(const SlamResult& whole, const std::vector<char>& in_group, const Pose2& T_part_map, SlamResult& part) {
  std::vector<std::int32_t> number(in_group.size(), -1), piece_number(in_group.size() + 1, -1);
  std::vector<char> drawn;
  for (std::size_t i = 0; i < in_group.size(); ++i) {
    if (!in_group[i]) continue;
    number[i] = static_cast<std::int32_t>(part.keyframes.size());
    MapKeyframe keyframe = whole.keyframes[i];
    keyframe.T_map_base = T_part_map * keyframe.T_map_base;
    std::int32_t& piece = piece_number[static_cast<std::size_t>(keyframe.piece)];
    if (piece < 0) piece = part.pieces++;
    keyframe.piece = piece;
    part.keyframes.push_back(keyframe);
    drawn.push_back(part.drawn[i]);
  }
  part.drawn = std::move(drawn);
  for (MapEdge edge : whole.edges) {
    edge.from = number[static_cast<std::size_t>(edge.from)];
    edge.to = number[static_cast<std::size_t>(edge.to)];
    if (edge.from < 0 || edge.to < 0) continue;
    part.edges.push_back(edge);
    part.loops.in_graph += edge.loop && edge.enabled;
  }
  part.loops.found = part.loops.accepted = part.loops.in_graph;
}

/// Scans of the group's sessions, numbered anew.
void take_scans(const SlamResult& whole, const ScanLedger& ledger, const std::vector<char>& session_in_group,
                const std::vector<Pose2>& poses, const std::vector<char>& on_map, SlamResult& part) {
  std::vector<ScanId> number(whole.scans.size(), -1);
  for (std::size_t i = 0; i < whole.scans.size(); ++i) {
    const std::size_t session = ledger.session_of(i);
    if (!session_in_group[session]) continue;
    const bool begins = i == 0 || ledger.session_of(i - 1) != session;
    number[i] = static_cast<ScanId>(part.scans.size());
    if (begins) part.sessions.push_back({number[i], 0});
    ScanResult scan = whole.scans[i];
    scan.T_map_base = poses[i];
    scan.on_map = on_map[i] != 0;
    part.scans.push_back(std::move(scan));
  }
  for (MapKeyframe& keyframe : part.keyframes) keyframe.scan = number[static_cast<std::size_t>(keyframe.scan)];
}

}  // namespace

void make_parts(const Backend& backend, const ScanLedger& ledger, const std::vector<Pose2>& poses, bool refined,
                std::size_t frame_session, const SlamOptions& options, SlamResult& result) {
  result.sessions.push_back({});
  for (const ScanId first : ledger.sessions) result.sessions.push_back({first, 0});
  const std::vector<int> first_of = first_of_group(backend, result.sessions.size());
  const std::vector<int> groups = groups_by_size(backend, first_of);
  if (groups.size() < 2) return;
  for (const int group : groups) {
    std::vector<char> session_in_group, in_group;
    for (const int first : first_of) session_in_group.push_back(static_cast<char>(first == group));
    for (const Keyframe& k : backend.keyframes())
      in_group.push_back(session_in_group[static_cast<std::size_t>(k.session)]);
    SlamResult part;
    part.deskewed = result.deskewed;
    part.drawn = drawn_of(backend, in_group, options.slam.largest_piece);
    const auto first = static_cast<std::size_t>(std::find(in_group.begin(), in_group.end(), 1) - in_group.begin());
    const Pose2 T_part_map = first_of[frame_session] == group || first == in_group.size()
                                 ? Pose2{}
                                 : backend.keyframes()[first].T_odom_base * backend.poses()[first].inverse();
    std::vector<Pose2> moved;
    for (const Pose2& pose : poses) moved.push_back(T_part_map * pose);
    const std::vector<char> on_map = scans_on_map(backend, ledger, part.drawn);
    draw_result(backend, moved, refined, T_part_map, on_map, options, part);
    take_graph(result, in_group, T_part_map, part);
    take_scans(result, ledger, session_in_group, moved, on_map, part);
    result.parts.push_back(std::move(part));
    for (std::size_t s = 0; s < first_of.size(); ++s) {
      if (session_in_group[s]) result.sessions[s].part = static_cast<std::int32_t>(result.parts.size()) - 1;
    }
  }
}

}  // namespace phasescan
