#include <froude/fields/cut_layer.h>

namespace froude::detail {
namespace {

template <typename T>
std::size_t bytes(const std::vector<T>& v) {
  return v.capacity() * sizeof(T);
}

template <typename T>
std::uint32_t append(std::vector<T>& to, const std::vector<T>& from) {
  const auto begin = static_cast<std::uint32_t>(to.size());
  to.insert(to.end(), from.begin(), from.end());
  return begin;
}

}  // namespace

void CutStore::clear() {
  records.clear();
  areas.clear();
  openings.clear();
  walls.clear();
  slabs.clear();
}

std::uint32_t CutStore::keep() {
  CutRecord record;
  record.areaCount = static_cast<std::uint32_t>(cutter.areas().size());
  record.openingCount = static_cast<std::uint32_t>(cutter.openings().size());
  record.wallCount = static_cast<std::uint32_t>(cutter.walls().size());
  record.area = append(areas, cutter.areas());
  record.opening = append(openings, cutter.openings());
  record.wall = append(walls, cutter.walls());
  if (record.areaCount > 1) {
    record.slabCount = static_cast<std::uint32_t>(cutter.slabs().size());
    record.slab = append(slabs, cutter.slabs());
  }
  records.push_back(record);
  return static_cast<std::uint32_t>(records.size() - 1);
}

void CutLayer::sort() {
  const std::vector<CutPiece>& all = pieces.pieces();
  order_.clear();
  for (std::uint32_t p = 0; p < all.size(); ++p) order_.emplace_back(all[p].key, p);
  std::sort(order_.begin(), order_.end());
  sorted_.clear();
  keys_.clear();
  starts_.clear();
  for (const auto& [key, piece] : order_) {
    if (keys_.empty() || keys_.back() != key) {
      keys_.push_back(key);
      starts_.push_back(static_cast<std::uint32_t>(sorted_.size()));
    }
    sorted_.push_back(all[piece]);
  }
  starts_.push_back(static_cast<std::uint32_t>(sorted_.size()));
}

void CutLayer::prepareStores(std::size_t count) {
  while (stores_.size() < count) stores_.push_back(std::make_unique<CutStore>());
  for (auto& store : stores_) store->clear();
}

std::size_t CutLayer::memoryBytes() const {
  std::size_t sum = pieces.memoryBytes() + bytes(order_) + bytes(sorted_) + bytes(keys_) + bytes(starts_);
  for (const auto& store : stores_) {
    sum += sizeof *store + bytes(store->records) + bytes(store->areas) + bytes(store->openings) + bytes(store->walls) +
           bytes(store->slabs);
  }
  return sum;
}

}  // namespace froude::detail
