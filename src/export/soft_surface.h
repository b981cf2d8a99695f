// Triangles and links of a world's soft bodies as frames show them, with how far each is strained.
#pragma once

#include <array>
#include <vector>

#include <froude/solver/world.h>

namespace froude::exporting {

/// Numbers are those of the soft particles' pool; what is torn is left out. Strain is the largest |principal stretch −
/// 1| [1]: 0 for what only moves and turns, above 1 for a triangle that is turned over.
struct SoftSurface {
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<float> strain;                          ///< of each triangle
  std::vector<std::array<std::uint32_t, 2>> outline;  ///< edges of bodies of triangles, the body on their left
  std::vector<std::array<std::uint32_t, 2>> links;    ///< of ropes
  std::vector<float> linkStrain;
  std::vector<float> linkThickness;  ///< [m]
};

/// The present state; empty where the world has no soft bodies. Cost: O(triangles).
SoftSurface softSurface(const World& world);

}  // namespace froude::exporting
