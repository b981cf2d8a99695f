// Pieces of outlines sorted into the cells that they touch, and the cells cut by them. Internal.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <froude/fields/cell_cutter.h>

namespace froude::detail {

/// A cell as it was cut: places in its store's arrays.
struct CutRecord {
  std::uint32_t area = 0, areaCount = 0;
  std::uint32_t opening = 0, openingCount = 0;
  std::uint32_t wall = 0, wallCount = 0;
  std::uint32_t slab = 0, slabCount = 0;  // of cells of several parts
};

/// Cells that one task cuts.
struct CutStore {
  CellCutter cutter;
  std::vector<CutRecord> records;
  std::vector<double> areas;
  std::vector<CutOpening> openings;
  std::vector<CutPartWall> walls;
  std::vector<CutSlab> slabs;
  std::vector<CutPiece> gathered;  // pieces of a cell that are in two places

  void clear();
  /// What the cutter has found becomes a record; its index.
  std::uint32_t keep();
};

/// A listed cell, and where what is known of it is; no store: it is solid.
struct CutSource {
  std::uint64_t key = 0;
  const CutStore* store = nullptr;
  std::uint32_t record = 0;
  const CutRecord& get() const { return store->records[record]; }
};

/// Pieces by cell, in the order of keys.
class CutLayer {
 public:
  CutPieces pieces;

  /// After pieces were added. Cost: a sort of them.
  void sort();
  std::size_t cellCount() const { return keys_.size(); }
  std::uint64_t keyOf(std::size_t cell) const { return keys_[cell]; }
  std::span<const CutPiece> piecesOf(std::size_t cell) const {
    return {sorted_.data() + starts_[cell], starts_[cell + 1] - starts_[cell]};
  }
  /// Makes room for cells that are cut by so many tasks.
  void prepareStores(std::size_t count);
  CutStore& store(std::size_t task) { return *stores_[task]; }
  std::size_t memoryBytes() const;

 private:
  std::vector<std::pair<std::uint64_t, std::uint32_t>> order_;
  std::vector<CutPiece> sorted_;
  std::vector<std::uint64_t> keys_;
  std::vector<std::uint32_t> starts_;
  std::vector<std::unique_ptr<CutStore>> stores_;  // each stays where it is
};

}  // namespace froude::detail
