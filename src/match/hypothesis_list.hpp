/// Lists of hypotheses: which are one answer, which comes first.
#pragma once

#include <cstddef>
#include <vector>

#include "match/global_search.hpp"

namespace phasescan {

bool same_pose(const Pose2& a, const Pose2& b, double metres, double radians);

/// Whether both poses are one answer in a place of that scale.
bool same_answer(const Pose2& a, const Pose2& b, double scale_m);

/// Total orders by score and by coarse sum, so that equals come out alike whatever the sort.
bool better(const Hypothesis& a, const Hypothesis& b);
bool coarsely_better(const Hypothesis& a, const Hypothesis& b);

/// Sorts `all`, best first, and leaves in `distinct` those that are answers of their own.
void sort_distinct(std::vector<Hypothesis>& all, double scale_m, std::vector<Hypothesis>& distinct);

/// Keeps the best, and among them one that turned another way, if there is any: along a corridor the same twin at many
/// places would fill the list.
void keep_finalists(std::size_t most, std::vector<Hypothesis>& sorted);

/// Twins that explain the scans as well, within `margin` of the best score: the one that turned less comes first, as
/// sensors turn little more often than far. The others stay, and the answer stays ambiguous. Returns whether another
/// comes first now.
bool prefer_less_turn(double margin, std::vector<Hypothesis>& sorted);

}  // namespace phasescan
