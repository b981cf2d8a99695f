// EdgeSieve: which edges can be the nearest to some point of a box? The pruning behind the cells of an EdgeGrid.
// Internal.
#pragma once

#include <vector>

#include <froude/base/aligned.h>
#include <froude/fields/edge_grid.h>
#include <froude/fields/sieve_loop.h>

namespace froude::detail {

/// Keeps edges on a stack, so that the boxes within a box start from what was kept for it. Not for several threads.
class EdgeSieve {
 public:
  /// The edges of one source that a box keeps: [begin, end) of the stack.
  struct Group {
    std::size_t begin, end;
    double least, most;  // no point of the box is nearer to the outline, none is farther [m]
    bool inside;         // the whole box is; told if it is far, or if exactness was wanted
  };
  /// What a pass needs to find out.
  struct Wanted {
    double reach;  // outlines that are farther from the whole box are dropped [m]
    bool exact;    // the least distance and whether the box is inside; else a bound of it, and inside only if far
  };

  explicit EdgeSieve(const EdgeGrid& grid) : grid_(grid) {}

  /// Appends the edges among [begin, end) that can be nearest to a point of `box`, source by source, and their groups.
  /// False if the whole box is inside a source, deeper than the reach. Cost: O(end − begin).
  bool keepNearest(const Box& box, std::size_t begin, std::size_t end, const Wanted& wanted);
  /// Appends the edges among [begin, end) of which some point of `box` is within `reach` [m].
  void keepWithin(const Box& box, std::size_t begin, std::size_t end, double reach);

  std::vector<std::uint32_t>& stack() { return stack_; }
  std::vector<Group>& groups() { return groups_; }

 private:
  void dropDominated(std::size_t groupMark, double upper);
  bool centerInside(const Vec2& center, std::size_t begin, std::size_t end) const;

  const EdgeGrid& grid_;
  const SieveLoop loop_ = sieveLoop(bestSimdTarget());
  std::vector<std::uint32_t> stack_;
  std::vector<Group> groups_;
  AlignedArray<double> squares_;
};

}  // namespace froude::detail
