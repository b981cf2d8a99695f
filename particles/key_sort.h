// A stable counting sort by small whole numbers: the order of particles by cell, whatever the cells are.
#pragma once

#include <cstdint>
#include <span>

#include <froude/base/aligned.h>
#include <froude/base/api.h>

namespace froude {

/// The result depends on the input alone, not on threads. Allocates only where a sort is larger than all before.
class FROUDE_API KeySort {
 public:
  /// keys: below keyCount, fewer than 2³² of them. Cost: O(keys + keyCount); see docs/decisions.
  void sort(std::span<const std::uint32_t> keys, std::size_t keyCount);

  /// new[i] = old[order()[i]] sorts by key and keeps the order of equal ones.
  std::span<const std::uint32_t> order() const { return order_.span(); }
  /// True if `order()` is 0, 1, 2, …: nothing to permute.
  bool sorted() const { return sorted_; }
  /// keyCount + 1 offsets: where each key starts in the order.
  std::span<const std::uint32_t> start() const { return start_.span(); }
  std::size_t memoryBytes() const;

 private:
  void sortSerial(std::span<const std::uint32_t> keys, std::size_t keyCount);
  void sortParallel(std::span<const std::uint32_t> keys, std::size_t keyCount, std::size_t chunks);

  AlignedArray<std::uint32_t> order_, start_;
  AlignedArray<std::uint32_t> histograms_;  ///< one per chunk of keys, then the places they write to
  AlignedArray<std::uint32_t> blockSums_;
  bool sorted_ = true;
};

}  // namespace froude
