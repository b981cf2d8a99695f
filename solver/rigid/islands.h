// Bodies that touch, directly or through others: they sleep together or not at all.
#pragma once

#include <vector>

#include <froude/solver/rigid/contact_list.h>

namespace froude {

/// Union-find over the contacts of a step. The smallest number is an island's root, so that islands do not depend on
/// the order. Each can be stirred: then it does not rest.
class Islands {
 public:
  /// Of free bodies (`isFree` by body, the domain's last is 0); all rest. Cost: near O(bodies + contacts).
  void join(const std::vector<ContactRef>& touching, const std::vector<std::uint8_t>& isFree);
  /// All rest again.
  void calm() { rests_.assign(parent_.size(), 1); }
  void stir(std::uint32_t body) { rests_[rootOf(body)] = 0; }
  /// Stirs those that something touches which moves and is not free: `still` by body.
  void stirByDriven(const std::vector<ContactRef>& touching, const std::vector<std::uint8_t>& isFree,
                    const std::vector<std::uint8_t>& still);
  bool rests(std::uint32_t body) { return rests_[rootOf(body)] != 0; }

 private:
  std::uint32_t rootOf(std::uint32_t body);

  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> rests_;  // by root
};

}  // namespace froude
