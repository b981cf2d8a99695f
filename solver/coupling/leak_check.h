// The certificate of a particle's path through a sub-step: did its centre get into or through an obstacle?
#pragma once

#include <froude/solver/coupling/particle_path.h>

namespace froude {

/// What a path did that it should not have.
struct PathLeak {
  bool leaked = false;
  bool inside = false;  // its end is in a solid; else it went in and out again
  int body = -1;        // through whose boundary, where it is not inside
  Vec2 at{0, 0};        // start of the piece that entered [m]
};

/// Checks the path from x that `followPath` resolved, ending at `end` [m]: each straight piece by exact orientation
/// against the edges near it, in the frame of the polygon, and the end by location. What the filter passes is no
/// obstacle. In the frame of a polygon that turns the path is a curve; it is taken in chords over at most 0.01 rad, so
/// what dips into such a polygon less deep than 1.3e-5 of its distance to the polygon's origin, and out again within a
/// chord, is not seen. No allocation, any number of threads. Cost: a look-up for each piece that is free; bullets.toml,
/// where a quarter of the bullets is checked, ran a fifth longer with it, a dam break 2 % (instructions).
PathLeak checkPath(const Obstacles& obstacles, const Vec2& x, const Vec2& end, const DiscContact& disc,
                   const PathResult& path);

}  // namespace froude
