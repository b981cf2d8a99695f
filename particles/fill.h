// Filling a polygon with particles: on a lattice for fluids, at random for bullets.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <froude/base/api.h>
#include <froude/base/error.h>
#include <froude/base/parallel.h>
#include <froude/base/random.h>
#include <froude/base/types.h>

namespace froude {

class Polygon;

/// A shape that cannot be filled: wrong spacing, no free place, more points than the caller allows.
class FROUDE_API FillError : public Error {
 public:
  using Error::Error;
};

struct FillResult {
  std::vector<Vec2> points;  ///< [m], row by row from below, x rising within a row
  std::size_t cut = 0;       ///< places of the lattice inside the shape that were blocked
};

/// The lattice (xmin + (i+½)·spacing, ymin + (j+½)·spacing) over the shape's bounding box: all places inside the shape
/// for which isBlocked is false. A hole is outside, and so is the boundary (to 1e-9 spacings). FillError if spacing [m]
/// is not a positive number or the lattice has more than `limit` places. Cost: O(places + rows · edges).
FROUDE_API FillResult fillLattice(const Polygon& shape, double spacing, FunctionRef<bool(const Vec2&)> isBlocked,
                                  std::size_t limit = std::size_t{1} << 30);
FROUDE_API FillResult fillLattice(const Polygon& shape, double spacing);

/// `count` places uniformly at random in the shape [m], independent of each other, by rejection in its bounding box
/// from the stream; a place for which isBlocked is true is drawn again. FillError if 10,000 draws in a row find no free
/// place.
FROUDE_API std::vector<Vec2> fillRandom(const Polygon& shape, std::size_t count, RandomStream& random,
                                        FunctionRef<bool(const Vec2&)> isBlocked);
FROUDE_API std::vector<Vec2> fillRandom(const Polygon& shape, std::size_t count, RandomStream& random);

/// Points that are already there (other blocks, live particles), for cutting out around them.
class FROUDE_API PlacedPoints {
 public:
  /// clearance [m] > 0: nearer than this is taken. For blocks whose lattices do not match, 0.9 spacing avoids
  /// over-dense seams; two lattices that abut at a whole spacing are not cut. FillError if it is not a positive number.
  explicit PlacedPoints(double clearance);
  void add(const Vec2& point);
  void add(std::span<const Vec2> points);
  /// True if a placed point is nearer than the clearance. Cost: O(points in 9 cells of the clearance's size).
  bool isTaken(const Vec2& point) const;
  std::size_t size() const { return points_.size(); }

 private:
  static constexpr std::uint32_t kEnd = 0xFFFFFFFFu;
  static std::uint64_t key(double cx, double cy);

  double clearance_;
  std::vector<Vec2> points_;
  std::vector<std::uint32_t> next_;                        ///< chain of the points of one cell
  std::unordered_map<std::uint64_t, std::uint32_t> last_;  ///< cell → its newest point; looked up, never iterated
};

}  // namespace froude
