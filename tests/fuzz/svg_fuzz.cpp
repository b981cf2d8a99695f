// Fuzzes shapes from drawings: whatever the bytes, there is a sound polygon or a DrawingError in words, in bounded
// time.
#include <cstdlib>

#include "scene/svg_drawing.h"

namespace {

/// What every polygon promises.
void expectSound(const froude::Polygon& polygon) {
  if (!(polygon.area() > 0.0) || polygon.edgeCount() < 3 || !polygon.bounds().max.allFinite()) std::abort();
}

/// What is no XML is taken as path data, so that outlines are fuzzed too and not only documents.
std::string drawingOf(std::string path) {
  for (char& c : path)
    if (c == '"' || c == '&' || static_cast<unsigned char>(c) < 0x20 || static_cast<unsigned char>(c) > 0x7e) c = ' ';
  return "<svg><path id=\"a\" fill-rule=\"" + std::string(path.size() % 2 == 0 ? "evenodd" : "nonzero") + "\" d=\"" +
         path + "\"/></svg>";
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string text(reinterpret_cast<const char*>(data), size);
  if (text.find('<') == std::string::npos) text = drawingOf(text);
  // The id "a" stands in many of the corpus' drawings.
  for (const char* id : {"", "a"}) {
    try {
      std::vector<std::string> notes;
      expectSound(froude::scene::svgPolygonOf(text, "fuzz.svg", id, 0.0, 0.0, &notes));
    } catch (const froude::scene::DrawingError& error) {
      if (std::string(error.what()).rfind("fuzz.svg:", 0) != 0) std::abort();
    }
  }
  return 0;
}
