#include <froude/solver/bullet/flight.h>

namespace froude {
namespace {

double freeTravel(const FreeMap::View& map, double x, double y) {
  const double cx = (x - map.originX) * map.inverse, cy = (y - map.originY) * map.inverse;
  if (!(cx >= 0.0 && cy >= 0.0 && cx < map.nx && cy < map.ny)) return 0.0;
  const auto ix = static_cast<std::ptrdiff_t>(cx), iy = static_cast<std::ptrdiff_t>(cy);
  const double offX = cx - (static_cast<double>(ix) + 0.5), offY = cy - (static_cast<double>(iy) + 0.5);
  return map.quantum * map.cells[iy * map.nx + ix] - map.cell * std::sqrt(offX * offX + offY * offY);
}

}  // namespace

FlightResult flyScalar(const Flight& f, std::size_t begin, std::size_t end, std::uint32_t* near) {
  FlightResult result;
  for (std::size_t i = begin; i < end; ++i) {
    const double wx = f.vx[i] + f.halfKick.x(), wy = f.vy[i] + f.halfKick.y();
    const double travelX = f.dt * wx, travelY = f.dt * wy;
    const double length = std::sqrt(travelX * travelX + travelY * travelY);
    const double alongX = travelX / length, alongY = travelY / length;
    double done = freeTravel(f.map, f.x[i], f.y[i]), step = done;
    for (int k = 1; k < kFlightSteps && done <= length && step > 0.0; ++k) {
      step = freeTravel(f.map, f.x[i] + done * alongX, f.y[i] + done * alongY);
      done += step;
    }
    if (!(done > length)) {
      near[result.near++] = static_cast<std::uint32_t>(i);
      continue;
    }
    f.x[i] += travelX;
    f.y[i] += travelY;
    f.vx[i] = wx + f.halfKick.x();
    f.vy[i] = wy + f.halfKick.y();
    result.left |= hasLeft(f.domain, f.x[i], f.y[i]);
  }
  return result;
}

}  // namespace froude
