// What a fluid's pressure does to soft bodies.
#include <cmath>

#include <froude/solver/soft/soft_bodies.h>

namespace froude {

// What of a body gives way with a node of its outline in a sub-step: the node's own mass and what a wave reaches, at
// most twice the body's mass over its outline's length: of a thin plate that is all that is behind it, of a disc what
// makes its shift as quick as it is.
void SoftBodies::addWalls(std::size_t i) {
  const SoftBody& b = body(i);
  if (b.def.model == SoftModel::Rope) return;
  const auto& points = b.def.mesh->points;
  std::vector<std::int64_t> nodeOf(points.size(), -1);
  std::vector<double> length(points.size(), 0.0);
  double whole = 0.0;
  for (const auto& [from, to] : b.def.mesh->outline) {
    const double edge = (points[to] - points[from]).norm();
    whole += edge;
    length[from] += 0.5 * edge;
    length[to] += 0.5 * edge;
  }
  auto node = [&](std::uint32_t point) {
    if (nodeOf[point] < 0) {
      nodeOf[point] = static_cast<std::int64_t>(walls_.nodes().size());
      wallPoint_.push_back(static_cast<std::uint32_t>(first_[i] + point));
      walls_.nodes().emplace_back();
      wallInertia_.push_back({b.mass[point], std::sqrt(b.def.density * b.lame.waveModulus()) * length[point],
                              2.0 * b.totalMass / whole * length[point]});
    }
    return static_cast<std::uint32_t>(nodeOf[point]);
  };
  for (const auto& [from, to] : b.def.mesh->outline) {
    const std::uint32_t first = node(from), second = node(to);
    walls_.edges().push_back({first, second, softOwner(i), {b.def.group, b.def.collidesWith}});
  }
}

SoftWalls& SoftBodies::showWalls(double dt, double reach) {
  for (std::size_t k = 0; k < walls_.nodes().size(); ++k) {
    SoftWalls::Node& n = walls_.nodes()[k];
    const std::uint32_t i = wallPoint_[k];
    const Inertia& inertia = wallInertia_[k];
    const bool held = body(pool_.column(bodyOf_)[i]).inverseMass[i - first_[pool_.column(bodyOf_)[i]]] == 0.0;
    n.inverseInertia = held ? 0.0 : 1.0 / std::min(inertia.own + inertia.rate * dt, inertia.most);
    n.velocity = !held ? Vec2(pool_.column(wet_->nextX)[i], pool_.column(wet_->nextY)[i]) : Vec2(0.0, 0.0);
    n.end = Vec2(pool_.x()[i], pool_.y()[i]) + dt * n.velocity;
    n.expected = dt * Vec2(pool_.column(wet_->forceX)[i], pool_.column(wet_->forceY)[i]);
    n.impulse = Vec2(0.0, 0.0);
  }
  walls_.sort(reach);
  return walls_;
}

double SoftBodies::fastest() const {
  const auto vx = pool_.vx(), vy = pool_.vy();
  double most = 0.0;
  for (std::size_t i = 0; i < pool_.size(); ++i) most = std::max(most, vx[i] * vx[i] + vy[i] * vy[i]);
  return std::sqrt(most);
}

void SoftBodies::takePressure(double dt) {
  for (std::size_t k = 0; k < walls_.nodes().size(); ++k) {
    const Vec2& impulse = walls_.nodes()[k].impulse;
    const std::uint32_t i = wallPoint_[k];
    pool_.column(wet_->forceX)[i] = impulse.x() / dt;
    pool_.column(wet_->forceY)[i] = impulse.y() / dt;
    pressureImpulse_[pool_.column(bodyOf_)[i]] += impulse;
  }
}

void SoftBodies::rememberMiddle() {
  std::copy(x_.begin(), x_.end(), middleX_.begin());
  std::copy(y_.begin(), y_.end(), middleY_.begin());
}

// From the mean velocities of the sub-step's halves. A velocity of one moment would be that of the fastest wave; the
// mean of the whole is half a sub-step late, which a fluid of more than twice the walls' inertia answers with ever
// more.
void SoftBodies::foresee(double dt, int parts) {
  const int before = parts / 2, after = parts - before;
  const double share = static_cast<double>(after) / parts;
  for (std::size_t i = 0; i < count(); ++i) {
    const std::size_t o = offset(i), f = first_[i];
    auto next = [&](const AlignedArray<double>& start, const AlignedArray<double>& middle,
                    const AlignedArray<double>& end, std::size_t k) {
      const double late = parts * (end[o + k] - middle[o + k]) / (after * dt);
      if (before == 0) return late;
      const double early = parts * (middle[o + k] - start[o + k]) / (before * dt);
      return late + share * (late - early);
    };
    for (std::size_t k = 0; k < body(i).points(); ++k) {
      pool_.column(wet_->nextX)[f + k] = next(startX_, middleX_, x_, k);
      pool_.column(wet_->nextY)[f + k] = next(startY_, middleY_, y_, k);
    }
  }
}

}  // namespace froude
