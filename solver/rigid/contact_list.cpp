#include <froude/solver/rigid/contact_list.h>

#include <algorithm>

namespace froude {
namespace {

constexpr double kSkin = 0.1;        // of a piece's outer radius: how far it may move before pairs are looked for anew
constexpr double kStepsAhead = 3.0;  // and this many steps of its present travel
constexpr std::size_t kBlock = 64;
constexpr std::uint64_t kWallKey = std::uint64_t{1} << 62;
constexpr int kPieceBits = 24, kSlotBits = 30;

bool contains(const Box& outer, const Box& inner) {
  return outer.min.x() <= inner.min.x() && outer.min.y() <= inner.min.y() && outer.max.x() >= inner.max.x() &&
         outer.max.y() >= inner.max.y();
}

// Where the box gets to as well.
void extend(Box& box, const Vec2& way) {
  const Box there{box.min + way, box.max + way};
  box.include(there);
}

// The closed sides as boxes as deep as the domain is wide.
std::vector<ConvexShape> wallShapes(const DomainDef& domain) {
  const Box& in = domain.box;
  const double depth = in.size().maxCoeff();
  const Box out = in.grown(depth);
  const std::array<bool, 4> closed{domain.closed[0] && !domain.periodicX, domain.closed[1] && !domain.periodicX,
                                   domain.closed[2] && !domain.periodicY, domain.closed[3] && !domain.periodicY};
  const std::array<Box, 4> boxes{Box{out.min, {in.min.x(), out.max.y()}}, Box{{in.max.x(), out.min.y()}, out.max},
                                 Box{out.min, {out.max.x(), in.min.y()}}, Box{{out.min.x(), in.max.y()}, out.max}};
  std::vector<ConvexShape> walls;
  for (std::size_t k = 0; k < 4; ++k) {
    const Box& b = boxes[k];
    if (!closed[k]) continue;
    walls.emplace_back(std::vector<Vec2>{b.min, {b.max.x(), b.min.y()}, b.max, {b.min.x(), b.max.y()}});
  }
  return walls;
}

bool mayTouch(const BodySet& bodies, std::uint32_t a, std::uint32_t b) {
  if (a == b) return false;
  const auto n = static_cast<std::uint32_t>(bodies.size());
  if (a == n || b == n) return bodies.isFree(a == n ? b : a);
  if (!bodies.isFree(a) && !bodies.isFree(b)) return false;
  const BodyDef& da = bodies.definition(a);
  const BodyDef& db = bodies.definition(b);
  return CollisionFilter{da.group, da.collidesWith}.accepts(db.group, db.collidesWith);
}

}  // namespace

void ContactList::rebuild(const DomainDef& domain, const BodySet& bodies) {
  std::vector<std::unique_ptr<Shape>> known = std::move(shapes_);
  shapes_.clear();
  auto shapeOf = [&](const std::shared_ptr<const Polygon>& polygon) -> const Shape& {
    if (!shapes_.empty() && shapes_.back()->polygon == polygon) return *shapes_.back();
    for (const auto& s : shapes_) {
      if (s->polygon == polygon) return *s;
    }
    for (auto& s : known) {
      if (s == nullptr || s->polygon != polygon) continue;
      shapes_.push_back(std::move(s));
      return *shapes_.back();
    }
    shapes_.push_back(std::make_unique<Shape>(Shape{polygon, ConvexShape::piecesOf(*polygon)}));
    return *shapes_.back();
  };
  if (walls_ == nullptr) walls_ = std::make_unique<Shape>(Shape{nullptr, wallShapes(domain)});
  std::vector<std::uint64_t> keys;
  for (const Proxy& p : proxies_) keys.push_back(p.key);
  proxies_.clear();
  thickness_.clear();
  auto addPieces = [&](const Shape& shape, std::uint32_t body, std::uint64_t key) {
    double thin = kInfinity;
    for (const ConvexShape& piece : shape.pieces) {
      proxies_.push_back({&piece, body, key++});
      thin = std::min(thin, piece.innerRadius());
    }
    thickness_.push_back(thin);
  };
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const BodyId id = bodies.id(i);
    // A new body in an old slot is another one: the generation tells them apart.
    const std::uint64_t key =
        (std::uint64_t{id.slot} << kPieceBits) + (std::uint64_t{id.generation & 0xffu} << (kPieceBits + kSlotBits));
    addPieces(shapeOf(bodies.shape(i)), static_cast<std::uint32_t>(i), key);
  }
  addPieces(*walls_, static_cast<std::uint32_t>(bodies.size()), kWallKey);
  byKey_.resize(proxies_.size());
  rank_.resize(proxies_.size());
  for (std::uint32_t p = 0; p < proxies_.size(); ++p) byKey_[p] = p;
  auto keyOf = [&](std::uint32_t p) { return proxies_[p].key; };
  std::sort(byKey_.begin(), byKey_.end(), [&](std::uint32_t p, std::uint32_t q) { return keyOf(p) < keyOf(q); });
  for (std::uint32_t k = 0; k < byKey_.size(); ++k) rank_[byKey_[k]] = k;
  // Contacts outlast the numbers of their pieces.
  auto renumber = [&](std::uint32_t& proxy, std::uint32_t& body) {
    const std::uint64_t key = keys[proxy];
    const auto at = std::lower_bound(byKey_.begin(), byKey_.end(), key,
                                     [&](std::uint32_t p, std::uint64_t value) { return keyOf(p) < value; });
    if (at == byKey_.end() || keyOf(*at) != key) return false;
    proxy = *at;
    body = proxies_[proxy].body;
    return true;
  };
  std::erase_if(contacts_, [&](Contact& c) { return !renumber(c.a, c.bodyA) || !renumber(c.b, c.bodyB); });
  reach_.resize(proxies_.size());
  fat_.resize(proxies_.size());
  order_.clear();
  stale_ = true;
}

void ContactList::findReach(const BodyPoses& poses, Crew& crew) {
  crew.stage(proxies_.size(), 4 * kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t p = begin; p < end; ++p) {
      const Proxy& proxy = proxies_[p];
      Box box = proxy.shape->box(poses.pose[proxy.body]);
      extend(box, poses.drift[proxy.body]);
      reach_[p] = box.grown(poses.spread[proxy.body]);
    }
  });
}

bool ContactList::leftItsBox() const {
  for (std::size_t p = 0; p < proxies_.size(); ++p) {
    if (!contains(fat_[p], reach_[p])) return true;
  }
  return false;
}

// Insertion: from one time to the next the order hardly changes.
void ContactList::sortAlongX() {
  if (order_.size() != proxies_.size()) {
    order_.resize(proxies_.size());
    for (std::uint32_t p = 0; p < order_.size(); ++p) order_[p] = p;
    std::sort(order_.begin(), order_.end(), [&](std::uint32_t p, std::uint32_t q) {
      return fat_[p].min.x() < fat_[q].min.x() || (fat_[p].min.x() == fat_[q].min.x() && p < q);
    });
    return;
  }
  for (std::size_t k = 1; k < order_.size(); ++k) {
    const std::uint32_t p = order_[k];
    const double x = fat_[p].min.x();
    std::size_t at = k;
    for (; at > 0 && fat_[order_[at - 1]].min.x() > x; --at) order_[at] = order_[at - 1];
    order_[at] = p;
  }
}

// A wall or a floor, which overlaps all, costs one pass over all.
void ContactList::sweepAlongX(const BodySet& bodies) {
  sortAlongX();
  sorted_.clear();
  for (const std::uint32_t p : order_) sorted_.push_back(fat_[p]);
  found_.clear();
  for (std::size_t i = 0; i < sorted_.size(); ++i) {
    const Box box = sorted_[i];
    for (std::size_t j = i + 1; j < sorted_.size() && sorted_[j].min.x() <= box.max.x(); ++j) {
      if (sorted_[j].min.y() > box.max.y() || sorted_[j].max.y() < box.min.y()) continue;
      const std::uint32_t a = order_[i], b = order_[j];
      if (!mayTouch(bodies, proxies_[a].body, proxies_[b].body)) continue;
      found_.push_back(std::minmax(rank_[a], rank_[b]));
    }
  }
}

// By the first's rank in one counting pass; each one's partners are few.
void ContactList::sortByKey() {
  start_.assign(proxies_.size() + 1, 0);
  for (const auto& [a, b] : found_) ++start_[a + 1];
  for (std::size_t p = 1; p < start_.size(); ++p) start_[p] += start_[p - 1];
  partner_.resize(found_.size());
  for (const auto& [a, b] : found_) partner_[start_[a]++] = b;
  std::uint32_t begin = 0;
  for (std::size_t p = 0; p < proxies_.size(); ++p) {
    std::sort(partner_.begin() + begin, partner_.begin() + start_[p]);
    begin = start_[p];
  }
}

void ContactList::pairAnew(const BodySet& bodies) {
  sweepAlongX(bodies);
  sortByKey();
  before_.swap(contacts_);
  contacts_.clear();
  std::size_t old = 0;
  std::uint32_t k = 0;
  for (std::uint32_t first = 0; first < proxies_.size(); ++first) {
    for (; k < start_[first]; ++k) {
      const std::pair<std::uint32_t, std::uint32_t> pair(first, partner_[k]);
      auto ranks = [&](const Contact& c) { return std::pair(rank_[c.a], rank_[c.b]); };
      while (old < before_.size() && ranks(before_[old]) < pair) ++old;
      if (old < before_.size() && ranks(before_[old]) == pair) {
        contacts_.push_back(before_[old]);
        continue;
      }
      Contact& contact = contacts_.emplace_back();
      contact.a = byKey_[pair.first], contact.b = byKey_[pair.second];
      contact.bodyA = proxies_[contact.a].body, contact.bodyB = proxies_[contact.b].body;
    }
  }
}

void ContactList::collide(Contact& contact, const BodyPoses& poses) const {
  if (poses.still[contact.bodyA] != 0 && poses.still[contact.bodyB] != 0) return;
  const Contact last = contact;
  contact.count = 0;
  if (!reach_[contact.a].overlaps(reach_[contact.b])) return;
  const ConvexShape& a = shape(contact.a);
  const ConvexShape& b = shape(contact.b);
  const Transform& frame = poses.pose[contact.bodyA];
  const double margin = poses.margin(contact.bodyA, contact.bodyB);
  const ContactManifold m = contactManifold(a, b, poseIn(frame, poses.pose[contact.bodyB]), margin, contact.cache);
  contact.count = m.count;
  contact.normal = frame.rotation.apply(m.normal);
  for (std::uint32_t k = 0; k < m.count; ++k) {
    ContactPoint& point = contact.points[k];
    point = {frame.toWorld(m.points[k].at), m.points[k].separation, 0.0, 0.0, m.points[k].id};
    for (std::uint32_t old = 0; old < last.count; ++old) {
      if (last.points[old].id != point.id) continue;
      point.normalForce = last.points[old].normalForce;
      point.tangentForce = last.points[old].tangentForce;
    }
  }
}

void ContactList::update(const BodySet& bodies, const BodyPoses& poses, Crew& crew) {
  findReach(poses, crew);
  if (stale_ || leftItsBox()) {
    for (std::size_t p = 0; p < proxies_.size(); ++p) {
      const Proxy& proxy = proxies_[p];
      const bool wall = proxy.body == bodies.size();
      fat_[p] = reach_[p];
      if (wall) continue;
      extend(fat_[p], kStepsAhead * poses.drift[proxy.body]);
      fat_[p] = fat_[p].grown(kSkin * proxy.shape->outerRadius() + poses.spread[proxy.body]);
    }
    pairAnew(bodies);
    stale_ = false;
  }
  crew.stage(contacts_.size(), kBlock, [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k) collide(contacts_[k], poses);
  });
  touching_.clear();
  apart_.clear();
  for (std::uint32_t k = 0; k < contacts_.size(); ++k) {
    const Contact& c = contacts_[k];
    (c.count > 0 ? touching_ : apart_).push_back({k, c.bodyA, c.bodyB});
  }
}

namespace {

constexpr std::size_t kPairNumbers = 7, kPointNumbers = 12, kBoxNumbers = 4;

}  // namespace

// Value by value into plain arrays: padding has no defined bits.
void ContactList::flatten() {
  savedPairs_.clear();
  savedPoints_.clear();
  savedBoxes_.clear();
  for (const Contact& c : contacts_) {
    for (const std::uint32_t v : {c.a, c.b, c.cache.a, c.cache.b, c.count, c.points[0].id, c.points[1].id}) {
      savedPairs_.push_back(v);
    }
    for (const ContactPoint& p : c.points) {
      for (const double v : {p.at.x(), p.at.y(), p.separation, p.normalForce, p.tangentForce}) {
        savedPoints_.push_back(v);
      }
    }
    savedPoints_.push_back(c.normal.x()), savedPoints_.push_back(c.normal.y());
  }
  for (const Box& b : fat_) {
    for (const double v : {b.min.x(), b.min.y(), b.max.x(), b.max.y()}) savedBoxes_.push_back(v);
  }
}

void ContactList::restore() {
  contacts_.resize(savedPairs_.size() / kPairNumbers);
  for (std::size_t k = 0; k < contacts_.size(); ++k) {
    Contact& c = contacts_[k];
    const std::uint32_t* w = savedPairs_.data() + kPairNumbers * k;
    if (w[0] >= proxies_.size() || w[1] >= proxies_.size()) throw Error("saved contacts: the state is damaged");
    c.a = w[0], c.b = w[1], c.cache.a = w[2], c.cache.b = w[3], c.count = w[4];
    c.points[0].id = w[5], c.points[1].id = w[6];
    c.bodyA = proxies_[c.a].body, c.bodyB = proxies_[c.b].body;
    const double* r = savedPoints_.data() + kPointNumbers * k;
    for (ContactPoint& p : c.points) {
      p.at = {r[0], r[1]}, p.separation = r[2], p.normalForce = r[3], p.tangentForce = r[4];
      r += 5;
    }
    c.normal = {r[0], r[1]};
  }
  for (std::size_t p = 0; p < fat_.size(); ++p) {
    const double* b = savedBoxes_.data() + kBoxNumbers * p;
    fat_[p] = {{b[0], b[1]}, {b[2], b[3]}};
  }
  order_.clear();
}

// Pairs are numbers of proxies, which follow from the bodies.
void ContactList::archive(Archive& a) {
  flatten();
  const std::size_t n = a.count("contacts", contacts_.size());
  savedPairs_.resize(kPairNumbers * n);
  savedPoints_.resize(kPointNumbers * n);
  a.bytes("pairs", savedPairs_.data(), sizeof(std::uint32_t), savedPairs_.size());
  a.bytes("points", savedPoints_.data(), sizeof(double), savedPoints_.size());
  a.bytes("boxes", savedBoxes_.data(), sizeof(double), savedBoxes_.size());
  std::uint8_t stale = stale_ ? 1 : 0;
  a.value("stale", stale);
  if (!a.loading()) return;
  stale_ = stale != 0;
  restore();
}

}  // namespace froude
