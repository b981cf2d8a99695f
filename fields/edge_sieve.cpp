#include <froude/fields/edge_sieve.h>

#include <froude/fields/edge_grid_nearest.h>

namespace froude::detail {

bool EdgeSieve::keepNearest(const Box& box, std::size_t begin, std::size_t end, const Wanted& wanted) {
  const std::size_t groupMark = groups_.size();
  double upper = kInfinity;  // no point of the box is farther than this from its nearest source
  while (begin < end) {
    const std::uint32_t source = grid_.edges()[stack_[begin]].source;
    std::size_t groupEnd = grid_.oneOutline() ? end : begin + 1;
    while (groupEnd < end && grid_.edges()[stack_[groupEnd]].source == source) ++groupEnd;
    const std::size_t count = groupEnd - begin;
    const std::size_t first = stack_.size();
    stack_.resize(first + count);
    if (squares_.size() < 4 * count) squares_.resize(8 * count);
    const SieveResult found =
        loop_({grid_.edges().data(), stack_.data() + begin, count, box, grid_.rounding(), wanted.exact},
              squares_.data(), stack_.data() + first);
    stack_.resize(first + found.kept);
    const bool far = found.least > wanted.reach;
    const bool inside = found.least > 0.0 && (far || wanted.exact) && centerInside(box.center(), first, stack_.size());
    if (far) {
      if (inside) return false;
      stack_.resize(first);
    } else {
      groups_.push_back({first, stack_.size(), found.least, found.most, inside});
      upper = std::min(upper, found.most);
    }
    begin = groupEnd;
  }
  dropDominated(groupMark, upper);
  return true;
}

/// A source that lies outside the box and farther than another's farthest point is nowhere the nearest.
void EdgeSieve::dropDominated(std::size_t groupMark, double upper) {
  if (groups_.size() < groupMark + 2) return;
  std::size_t to = groups_[groupMark].begin;
  std::size_t kept = groupMark;
  for (std::size_t g = groupMark; g < groups_.size(); ++g) {
    Group group = groups_[g];
    if (!group.inside && group.least > upper * (1.0 + kSieveSlack) + grid_.rounding()) continue;
    const std::size_t first = to;
    for (std::size_t k = group.begin; k < group.end; ++k) stack_[to++] = stack_[k];
    group.begin = first;
    group.end = to;
    groups_[kept++] = group;
  }
  groups_.resize(kept);
  stack_.resize(to);
}

bool EdgeSieve::centerInside(const Vec2& center, std::size_t begin, std::size_t end) const {
  EdgeGrid::Nearest nearest{grid_, center};
  for (std::size_t k = begin; k < end; ++k) nearest.consider(stack_[k]);
  nearest.closeSource(grid_.edges()[stack_[begin]].source);
  return nearest.any && nearest.best < 0.0;
}

void EdgeSieve::keepWithin(const Box& box, std::size_t begin, std::size_t end, double reach) {
  for (std::size_t k = begin; k < end; ++k) {
    const std::uint32_t edge = stack_[k];
    if (squaredDistance(grid_.edges()[edge], box, grid_.rounding()) <= reach * reach) stack_.push_back(edge);
  }
}

}  // namespace froude::detail
