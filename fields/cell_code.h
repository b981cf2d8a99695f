// CellCode: what a cell of an EdgeGrid keeps in 32 bits: where its edges are listed, or how it is divided. Internal.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>

namespace froude::detail {

/// 0: the cell is far from every outline. Else, from the highest bit down:
///   0 | count: 5 | offset: 26   the edges lists[offset … offset + count); count 0: lists[offset] is the count of a
///   longer
///                               list, or of one that mixes outlines, and the edges follow it
///   1 | shift: 3 | first: 28    2^shift × 2^shift parts of the cell, row by row, at partCodes[first]; the code of the
///                               whole cell's list is at first − 1
/// lists[e] is e for every edge e, so that a cell whose edges follow each other needs no list of its own.
using CellCode = std::uint32_t;

inline constexpr std::uint32_t kListOffsetBits = 26;
inline constexpr std::uint32_t kMostListed = 31;  // longest list whose count is in its code
inline constexpr std::uint32_t kPartsBits = 28;
inline constexpr std::uint32_t kDivided = 1u << 31;
inline constexpr std::uint32_t kListOffsetMask = (1u << kListOffsetBits) - 1;
inline constexpr std::uint32_t kFirstPartMask = (1u << kPartsBits) - 1;

/// The two ways in which a cell is divided: 4 × 4 parts, or 8 × 8.
inline constexpr std::uint32_t kPartsShift = 2;
inline constexpr std::uint32_t kManyPartsShift = 3;

constexpr bool isDivided(CellCode code) { return (code & kDivided) != 0; }
constexpr std::uint32_t listOffset(CellCode code) { return code & kListOffsetMask; }
constexpr std::uint32_t listCount(CellCode code) { return code >> kListOffsetBits; }
constexpr std::uint32_t firstPart(CellCode code) { return code & kFirstPartMask; }
constexpr std::uint32_t partsShift(CellCode code) { return (code >> kPartsBits) & 7u; }

constexpr CellCode listCode(std::uint32_t offset, std::uint32_t count) { return count << kListOffsetBits | offset; }
constexpr CellCode dividedCode(std::uint32_t first, std::uint32_t shift) {
  return kDivided | shift << kPartsBits | first;
}

/// Place in partCodes of the part that holds a point at (x, y) of a divided cell, in cells: 0 … 1, or a rounding
/// beyond.
inline std::size_t partIndex(CellCode code, double x, double y) {
  const int shift = static_cast<int>(partsShift(code));
  const int side = 1 << shift;
  const int i = std::clamp(static_cast<int>(x * side), 0, side - 1);
  const int j = std::clamp(static_cast<int>(y * side), 0, side - 1);
  return firstPart(code) + static_cast<std::size_t>(j << shift) + static_cast<std::size_t>(i);
}

}  // namespace froude::detail
