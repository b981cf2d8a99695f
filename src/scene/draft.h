// A scene in the making: what the readers of its sections hand to each other. Internal to this folder.
#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "scene/reader.h"
#include "scene/scene.h"

namespace froude::scene {

/// A block of particles that has been read but not filled.
struct BlockDraft {
  std::shared_ptr<const Polygon> shape;
  std::array<Expression, 2> velocity;
  bool cut = true;
  std::size_t count = 0;                   // bullets
  Place place, velocityPlace, countPlace;  // of the shape and these keys
  std::string path;                        // "fluid.block.0"
};

/// A soft body that has been read, for warnings and for what is placed beside it.
struct SoftDraft {
  Place place;                           // of its shape or path (copies share one)
  std::string path;                      // "soft.jelly"
  std::shared_ptr<const Polygon> shape;  // in the body's own coordinates; empty: a rope
};

struct Draft {
  Scene scene;
  std::vector<BlockDraft> fluidBlocks, bulletBlocks;
  std::vector<Place> bodyPlaces;       // of each body (copies share one), for warnings
  std::vector<std::string> bodyPaths;  // "body.gate"
  std::vector<Place> emitterPlaces;
  Place timeStepPlace, slipPlace;
  std::optional<Place> spacingPlace;  // empty: the default
  /// Shapes by the bits of their vertices: a resolved scene writes each copy out, and equal shapes are to be one again.
  std::map<std::string, std::shared_ptr<const Polygon>> shapes;
  std::map<std::pair<const Polygon*, double>, std::shared_ptr<const TriangleMesh>> meshes;  // by shape and spacing
  std::vector<SoftDraft> soft;
  bool fluidEmitted = false, bulletsEmitted = false;  // by some emitter

  void warn(const Place& place, const std::string& key, const std::string& text) {
    scene.warnings.push_back({place, key, text});
  }
};

/// A shape under the key `key` of `parent`: polygon with holes, box, regular or a drawing. Written down as a polygon.
/// Repairs become notes.
std::shared_ptr<const Polygon> readShape(TableReader& parent, const std::string& key, Draft& draft);
/// The polygon, or an equal one that was there before.
std::shared_ptr<const Polygon> sharedShape(Polygon polygon, Draft& draft);
/// From a point to the nearest edge [m]. Cost: O(edges).
double distanceToOutline(const Polygon& polygon, const Vec2& p);
/// The node that reads back as this polygon.
Node shapeNode(const Polygon& polygon);

/// The keys of a scene's root.
const std::vector<std::string>& sceneKeys();

// Each reads its part of the root, in this order (emitters decide with the blocks whether there is a fluid, gauges name
// bodies), and leaves it in the root's resolved table.
void readHeader(TableReader& root, Draft& draft);
void readDomain(TableReader& root, Draft& draft);
void readEmitters(TableReader& root, Draft& draft);
void readSinks(TableReader& root, Draft& draft);
void readBodies(TableReader& root, Draft& draft);
void readSoft(TableReader& root, Draft& draft);
void readBullets(TableReader& root, Draft& draft);
void readFluid(TableReader& root, Draft& draft);  // with [model]
void readOutput(TableReader& root, Draft& draft);
void readGauges(TableReader& root, Draft& draft);

/// Refuses a scene whose particles need more memory than the machine has; nothing has been placed yet.
void checkMemory(const Draft& draft);
/// Places the particles of all blocks outside bodies, walls and each other.
void seed(Draft& draft);
/// Looks for what runs but is probably not meant.
void judge(Draft& draft);
/// Its part for free bodies: overlaps at the start, hinges far away, what reaches out of the domain.
void judgeFreeBodies(Draft& draft);
/// Its part for soft bodies: overlaps at the start, triangles too coarse, sag under their own weight.
void judgeSoft(Draft& draft);

}  // namespace froude::scene
