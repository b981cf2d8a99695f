// Sweeps in the frame of a grid, shared by polygons and the world. Internal.
#pragma once

#include <froude/fields/chord.h>
#include <froude/fields/sweep.h>

namespace froude::detail {

/// True if every coordinate is finite.
inline bool finitePath(const Vec2& from, const Vec2& to) { return from.allFinite() && to.allFinite(); }

/// The skin for coordinates up to the largest of the grid and these points [m].
double skinFor(const EdgeGrid& grid, std::initializer_list<Vec2> points);

/// Where a sweep starts: its distance alone, or a bound of it. No more is wanted than whether it exceeds `enough`.
FieldSample startOf(const EdgeGrid& grid, const Vec2& center, double enough);

/// Fills `hit` and returns true if a disc at `center` overlaps by more than the skin, given the field's answer there.
bool startsInside(const EdgeGrid& grid, const FieldSample& atStart, const Vec2& center, const Chord& chord,
                  SweepHit* hit);

/// A disc that starts farther than this from every solid meets none on its way [m].
inline double freeDistance(const EdgeGrid& grid, const Vec2& from, const Vec2& to, double radius) {
  return radius + (to - from).norm() + 2.0 * skinFor(grid, {from, to});
}

/// How to shift a disc that touches at `center`, so that it is `clearance` [m] beyond its radius off the solid; zero if
/// it is already three quarters of that off, or if there is no room.
Vec2 pushOut(const EdgeGrid& grid, const Vec2& center, double radius, double clearance);

/// The whole sweep for a solid at rest, given the field's answer at the start.
SweepHit sweepStill(const EdgeGrid& grid, const Vec2& from, const Vec2& to, double radius, const FieldSample& atStart,
                    const SourceFilter* accepts);
SweepHit sweepChord(const EdgeGrid& grid, const Chord& chord, const FieldSample& atStart, const SourceFilter* accepts);

}  // namespace froude::detail
