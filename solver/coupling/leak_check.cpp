#include <froude/solver/coupling/leak_check.h>

namespace froude {

PathLeak checkPath(const Obstacles& obstacles, const Vec2& x, const Vec2& end, const DiscContact& disc,
                   const PathResult& path) {
  PathPiece piece{x, x, 0.0, 0.0};
  auto checkTo = [&](const Vec2& to, double time) {
    piece.to = to;
    piece.end = time;
    const Obstacles::Entry entry = obstacles.entry(piece, disc.filter);
    return PathLeak{entry.entered, false, entry.body, piece.from};
  };
  PathLeak leak;
  for (int k = 0; k < path.contacts && !leak.leaked; ++k) {
    const PathResult::Impulse& contact = path.impulses[static_cast<std::size_t>(k)];
    leak = checkTo(contact.at + disc.radius * contact.normal, contact.time);
    piece.from = piece.to;
    piece.begin = piece.end;
  }
  if (path.contacts > kMaxBounces) piece.carrier = path.impulses[kMaxBounces].body;
  if (!leak.leaked) leak = checkTo(end, 1.0);
  // A disc that overlapped nothing at the start and entered nothing is not inside at the end.
  if (leak.leaked || disc.radius == 0.0 || path.startedInside) leak.inside = obstacles.inside(end, disc.filter);
  leak.leaked = leak.leaked || leak.inside;
  return leak;
}

}  // namespace froude
