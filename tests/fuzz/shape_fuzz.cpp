// Fuzzes shapes that are typed: the bytes are the text behind `shape =`. There is a sound polygon or a SceneError at a
// place in the file; what is written down reads back as the same polygon, to the bit.
#include <cstdlib>

#include "scene/document.h"
#include "scene/draft.h"

namespace {

using namespace froude;

std::shared_ptr<const Polygon> read(const std::string& text, std::string* written) {
  const scene::Node document = scene::parseDocument("fuzz.toml", text);
  scene::TableReader root("fuzz.toml", document, "", {"shape"});
  scene::Draft draft;
  std::shared_ptr<const Polygon> polygon = scene::readShape(root, "shape", draft);
  *written = scene::toToml(root.resolved());
  return polygon;
}

bool same(const Polygon& a, const Polygon& b) {
  return std::equal(a.vertices().begin(), a.vertices().end(), b.vertices().begin(), b.vertices().end()) &&
         std::equal(a.ringStarts().begin(), a.ringStarts().end(), b.ringStarts().begin(), b.ringStarts().end());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (text.find("svg") != std::string::npos) return 0;  // opens files; it has a fuzzer of its own
  std::shared_ptr<const Polygon> polygon;
  std::string written, again;
  try {
    polygon = read("shape = " + text + "\n", &written);
  } catch (const scene::SceneError& error) {
    if (std::string(error.what()).rfind("fuzz.toml:", 0) != 0) std::abort();
    return 0;
  }
  if (!(polygon->area() > 0.0) || polygon->edgeCount() < 3) std::abort();
  if (!same(*read(written, &again), *polygon)) std::abort();
  return 0;
}
