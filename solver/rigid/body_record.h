// A body's definition as bytes, for saved states of worlds whose bodies were created by call.
#pragma once

#include <span>
#include <vector>

#include <froude/solver/definitions.h>

namespace froude {

/// Appends the definition: all of it but its script, of which only the number of pieces is kept.
void writeBodyRecord(const BodyDef& definition, std::vector<std::byte>* bytes);

/// A definition that was read back, and how much of the bytes it took.
struct BodyRecord {
  BodyDef definition;  // without script
  std::size_t scriptPieces = 0;
  std::size_t size = 0;  // [bytes]
};
/// Reads the first record. Throws Error where the bytes end too early.
BodyRecord readBodyRecord(std::span<const std::byte> bytes);

}  // namespace froude
