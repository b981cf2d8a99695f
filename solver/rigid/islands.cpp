#include <froude/solver/rigid/islands.h>

#include <algorithm>

namespace froude {

std::uint32_t Islands::rootOf(std::uint32_t body) {
  while (parent_[body] != body) {
    parent_[body] = parent_[parent_[body]];
    body = parent_[body];
  }
  return body;
}

void Islands::join(const std::vector<ContactRef>& touching, const std::vector<std::uint8_t>& isFree) {
  parent_.resize(isFree.size());
  for (std::uint32_t i = 0; i < parent_.size(); ++i) parent_[i] = i;
  for (const ContactRef& c : touching) {
    if (isFree[c.bodyA] == 0 || isFree[c.bodyB] == 0) continue;
    const std::uint32_t a = rootOf(c.bodyA), b = rootOf(c.bodyB);
    parent_[std::max(a, b)] = std::min(a, b);
  }
  calm();
}

void Islands::stirByDriven(const std::vector<ContactRef>& touching, const std::vector<std::uint8_t>& isFree,
                           const std::vector<std::uint8_t>& still) {
  for (const ContactRef& c : touching) {
    if (isFree[c.bodyA] == 0 && still[c.bodyA] == 0) stir(c.bodyB);
    if (isFree[c.bodyB] == 0 && still[c.bodyB] == 0) stir(c.bodyA);
  }
}

}  // namespace froude
