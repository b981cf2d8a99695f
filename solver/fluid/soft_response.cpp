#include <froude/solver/fluid/soft_response.h>

#include <froude/solver/fluid/pair_loops.h>

namespace froude {

void SoftResponse::begin(SoftWalls* walls, double length, double mass, double impulse) {
  walls_ = walls;
  length_ = length;
  links_.clear();
  first_.assign(1, 0);
  nodes_.clear();
  if (walls == nullptr) return;
  nodes_.resize(walls->nodes().size());
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const SoftWalls::Node& node = walls->nodes()[k];
    nodes_[k].inverseMass = node.inverseInertia * mass;
    nodes_[k].expected = node.expected / impulse;
  }
}

void SoftResponse::link(const WallLayer& layer, std::span<const double> x, std::span<const double> y) {
  if (walls_ == nullptr) return;
  layer.forEachLink([&](const WallLink& link) {
    if (!isSoftOwner(link.owner)) return;
    shares_.clear();
    walls_->share(link.owner, {x[link.particle], y[link.particle]}, kernel::kSupport * length_, shares_);
    for (const SoftWalls::Share& s : shares_) {
      links_.push_back({link.particle, s.node, s.weight, s.weight * static_cast<double>(link.gradientX),
                        s.weight * static_cast<double>(link.gradientY)});
    }
    first_.push_back(links_.size());
  });
}

void SoftResponse::addGain(double time, float* gain) const {
  const double way = time / length_;
  for (const Link& l : links_) {
    const Vec2& v = walls_->nodes()[l.node].velocity;
    gain[l.particle] -= static_cast<float>(way * (v.x() * l.x + v.y() * l.y));
  }
}

void SoftResponse::holdBack(const float* diagonal) {
  for (const Link& l : links_) {
    const double w = 2.0 / static_cast<double>(std::max(diagonal[l.particle], kSmallestDiagonal));
    double* hold = nodes_[l.node].hold;
    // A row of the particle has all its nodes: lumped onto each, by the share that it has.
    const double whole = l.weight > 0.0 ? 1.0 / l.weight : 0.0;
    hold[0] += w * whole * l.x * l.x, hold[1] += w * whole * l.x * l.y, hold[2] += w * whole * l.y * l.y;
  }
}

void SoftResponse::restore(const float* field, float* answered) const {
  for (const Link& l : links_) answered[l.particle] = field[l.particle];
}

void SoftResponse::follow(const float* kappa, double share, double past, float* answered) {
  for (Node& n : nodes_) n.sum = Vec2(0.0, 0.0);
  for (const Link& l : links_) {
    nodes_[l.node].sum += 2.0 * share * static_cast<double>(kappa[l.particle]) * Vec2(l.x, l.y);
  }
  for (Node& n : nodes_) {
    if (n.inverseMass == 0.0) continue;
    // (1 + w K) change = w (Σ 2κ G − expected) − q.
    const Vec2 rest = n.inverseMass * (n.sum - past * n.expected) - n.moved;
    const double xx = 1.0 + n.inverseMass * n.hold[0], xy = n.inverseMass * n.hold[1],
                 yy = 1.0 + n.inverseMass * n.hold[2], inverse = 1.0 / (xx * yy - xy * xy);
    n.moved += inverse * Vec2(yy * rest.x() - xy * rest.y(), xx * rest.y() - xy * rest.x());
  }
  for (const Link& l : links_) {
    const Vec2& q = nodes_[l.node].moved;
    answered[l.particle] -= static_cast<float>(l.x * q.x() + l.y * q.y());
  }
}

void SoftResponse::give(std::size_t n, const Vec2& impulse) {
  for (std::size_t k = first_[n]; k < first_[n + 1]; ++k) {
    walls_->nodes()[links_[k].node].impulse += links_[k].weight * impulse;
  }
}

}  // namespace froude
