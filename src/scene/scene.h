// A scene: what a file says, read, judged and resolved, ready to become a World.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <froude/solver/world.h>

namespace froude::scene {

/// A place in a scene file; line and column start at 1, 0 where unknown (a value given by --set).
struct Place {
  std::string file;
  int line = 0;
  int column = 0;
};

/// The scene is wrong: `what()` is "FILE:LINE:COLUMN: key: what is wrong, what would be right". Exit code 2.
class SceneError : public Error {
 public:
  SceneError(const Place& place, const std::string& key, const std::string& problem);
  const Place& place() const { return place_; }
  const std::string& key() const { return key_; }

 private:
  Place place_;
  std::string key_;
};

/// Something doubtful that does not stop a run, printed like an error with "warning:".
struct Warning {
  Place place;
  std::string key;
  std::string text;
  std::string line() const;  // as printed
};

/// A gauge, as the format describes it; unused fields keep their defaults.
struct GaugeDef {
  std::string name, type;
  double every = 0.0;              // [s]
  char axis = 'x';                 // front
  double quantile = 0.995;         // front
  double x = 0.0;                  // height
  Vec2 at{0, 0};                   // pressure, velocity; tip: of the shape at rest, in its own coordinates
  double window = 0.0;             // pressure [s]; 0: none
  Vec2 from{0, 0}, to{0, 0};       // profile
  int count = 0;                   // profile
  std::string body;                // force, pose
  std::string soft;                // tip, area
  std::optional<Species> species;  // energy, momentum, mass, count
};

struct PngDef {
  int width = 1280;
  Box view;                                          // default: the domain
  std::string color = "speed";                       // "speed" | "pressure" | "density"
  std::optional<std::array<double, 2>> range;        // default: fixed from the scene's own scales
  std::optional<std::array<double, 2>> strainRange;  // of soft bodies; default likewise
};

struct OutputDef {
  double every = 0.02;  // [s] of simulated time between frames
  bool h5 = true, png = true, vdb = false;
  double checkpoint = 60.0;  // [s] of wall time
  PngDef image;
};

/// Particles of a block, already placed, and what was cut from it.
struct SeededBlock {
  std::vector<Vec2> positions, velocities;
  std::size_t cut = 0;
};

/// A scene read from a file. Shapes are resolved, particles are placed; nothing has been written.
struct Scene {
  std::string file;  // as given
  std::string name;  // file name without .toml
  std::string title;
  double duration = 0.0;  // [s]
  WorldDef world;
  std::vector<SeededBlock> fluidBlocks, bulletBlocks;
  std::vector<GaugeDef> gauges;
  OutputDef output;
  std::vector<Warning> warnings;
  std::vector<std::string> notes;  // repairs of polygons, what was cut: said once, on stderr
  std::string resolved;            // a scene file of everything, shapes inlined, that gives the same run
  std::string sha256;              // of the file's bytes [hex]

  std::size_t fluidParticles() const;
  std::size_t bulletCount() const;
  std::size_t softPoints() const;
};

/// The words of `soft.model`.
const std::vector<std::pair<std::string, SoftModel>>& softModelNames();

/// One `--set PATH=VALUE`, applied after parsing and before checking.
using Override = std::pair<std::string, std::string>;

/// Reads, checks, resolves and seeds. Throws SceneError. The memory that the particles would need is judged before any
/// is placed.
Scene load(const std::string& file, const std::vector<Override>& overrides = {});

/// Builds the world of a scene and fills it with its particles.
World makeWorld(const Scene& scene);

/// A scene to check: how it is called in the findings, its file, and what is changed in it.
struct CheckItem {
  std::string label, file;
  std::vector<Override> changes;
};

/// `froude check`: prints problems on stderr, findings on stdout; returns the exit code.
int checkCommand(const std::vector<CheckItem>& items, bool strict, bool json);

}  // namespace froude::scene
