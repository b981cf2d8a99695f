#include "scene/svg_drawing.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <polyclipping/clipper.hpp>

namespace froude::scene {

namespace {

namespace clip = ClipperLib;

constexpr std::size_t kMostVertices = 100'000;
constexpr std::size_t kMostCrossings = 1'000'000;
constexpr std::uintmax_t kMostBytes = std::uintmax_t{16} << 20;
constexpr double kDefaultTolerance = 1.0 / 2000.0;  // of the larger side: a circle gets 71 vertices

std::string readFile(const std::string& path) {
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    throw DrawingError(fmt::format("{}: is a folder, right is an SVG drawing", path));
  std::ifstream stream(path, std::ios::binary);
  if (!stream)
    throw DrawingError(fmt::format("{}: {}", path,
                                   std::filesystem::exists(path, error)
                                       ? "cannot be read, right is a file with read permission"
                                       : "there is no such file, right is the path of a drawing"));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (!error && size > kMostBytes)
    throw DrawingError(fmt::format("{}: has {:.1f} MiB, right are at most {} MiB", path,
                                   static_cast<double>(size) / (1 << 20), kMostBytes >> 20));
  // Devices and pipes have no size and may have no end.
  std::string text(kMostBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (stream.bad()) throw DrawingError(fmt::format("{}: reading stopped half-way", path));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMostBytes)
    throw DrawingError(fmt::format("{}: has more than {} MiB, right are at most that", path, kMostBytes >> 20));
  return text;
}

/// Powers of two apart, about the middle of a box; coordinates stay below 2³⁰, where Clipper's products fit 64 bits.
class Lattice {
 public:
  explicit Lattice(const Box& box) {
    unit_ = std::exp2(std::ceil(std::log2(box.size().maxCoeff())) - 30.0);
    middle_ = (box.center() / unit_).array().round() * unit_;
  }
  double unit() const { return unit_; }

  /// The nearest point of the lattice, and the first vertex that was put there.
  clip::IntPoint snap(const Vec2& p) {
    const Vec2 q = (p - middle_) / unit_;
    const clip::IntPoint at(std::llround(q.x()), std::llround(q.y()));
    vertices_.emplace(std::pair(at.X, at.Y), p);
    return at;
  }
  Vec2 point(const clip::IntPoint& p) const {
    return middle_ + unit_ * Vec2(static_cast<double>(p.X), static_cast<double>(p.Y));
  }
  /// The vertex of the drawing that was put there, if any.
  const Vec2* vertex(const clip::IntPoint& p) const {
    const auto found = vertices_.find({p.X, p.Y});
    return found == vertices_.end() ? nullptr : &found->second;
  }

 private:
  double unit_;
  Vec2 middle_;
  std::map<std::pair<clip::cInt, clip::cInt>, Vec2> vertices_;
};

/// One outer ring with its holes, on the lattice.
struct Piece {
  clip::Path outer;
  clip::Paths holes;
};

/// Rings that are nowhere wider than a few lattice spacings come from rounding, not from a pen.
bool isSpeck(const clip::Path& path) {
  double around = 0.0;
  for (std::size_t i = 0, j = path.size() - 1; i < path.size(); j = i++)
    around += std::hypot(static_cast<double>(path[i].X - path[j].X), static_cast<double>(path[i].Y - path[j].Y));
  return std::abs(clip::Area(path)) <= 2.0 * around;
}

struct Edge {
  clip::IntPoint a, b;  // a.X <= b.X
};

int side(const Edge& e, const clip::IntPoint& p) {
  const clip::cInt turn = (e.b.X - e.a.X) * (p.Y - e.a.Y) - (e.b.Y - e.a.Y) * (p.X - e.a.X);
  return (turn > 0) - (turn < 0);
}

/// True if edges cross more than `limit` times: uniting takes memory and time for each crossing. Cost: n log n, and
/// each pair of edges whose x ranges overlap.
bool crossMoreOften(const std::vector<clip::Paths>& rings, std::size_t limit) {
  std::vector<Edge> edges, open;
  for (const clip::Paths& paths : rings)
    for (const clip::Path& path : paths)
      for (std::size_t i = 0, j = path.size() - 1; i < path.size(); j = i++)
        edges.push_back(path[j].X <= path[i].X ? Edge{path[j], path[i]} : Edge{path[i], path[j]});
  std::sort(edges.begin(), edges.end(), [](const Edge& e, const Edge& f) { return e.a.X < f.a.X; });
  std::size_t crossings = 0;
  for (const Edge& e : edges) {
    std::erase_if(open, [&](const Edge& f) { return f.b.X < e.a.X; });
    for (const Edge& f : open) crossings += side(e, f.a) * side(e, f.b) < 0 && side(f, e.a) * side(f, e.b) < 0;
    if (crossings > limit) return true;
    open.push_back(e);
  }
  return false;
}

class Merger {
 public:
  Merger(const std::vector<DrawnElement>& elements, const std::string& name, double tolerance)
      : elements_(elements), name_(name), tolerance_(tolerance) {}

  Polygon polygon(std::vector<std::string>* notes);

 private:
  Box bounds() const;
  clip::Paths rings(const DrawnElement& element, Lattice* lattice);
  std::vector<Piece> unite(const std::vector<clip::Paths>& filled) const;
  std::vector<std::size_t> elementsIn(const Piece& piece, const std::vector<clip::Paths>& filled) const;
  std::string names(const std::vector<std::size_t>& elements) const;
  Polygon build(const Piece& piece, const Lattice& lattice, const std::string& whose,
                std::vector<std::string>* notes) const;

  const std::vector<DrawnElement>& elements_;
  std::string name_;
  double tolerance_;
  std::size_t vertices_ = 0;
};

Box Merger::bounds() const {
  Box box;
  for (const DrawnElement& element : elements_)
    for (const std::vector<Curve>& subpath : element.subpaths)
      for (const Curve& curve : subpath) box.include(curve.bounds());
  return box;
}

clip::Paths Merger::rings(const DrawnElement& element, Lattice* lattice) {
  clip::Paths all;
  for (const std::vector<Curve>& subpath : element.subpaths) {
    if (subpath.empty()) continue;
    std::vector<Vec2> points{subpath.front().start()};
    try {
      for (const Curve& curve : subpath) {
        flatten(curve, tolerance_, kMostVertices, &points);
        if (vertices_ + points.size() > kMostVertices) throw TooManyPieces("");
      }
    } catch (const TooManyPieces&) {
      throw DrawingError(fmt::format(
          "{}: {}: the drawing has more than {} vertices at a tolerance of {:.3g} m, right is a larger one or a "
          "simpler drawing",
          element.place, element.name, kMostVertices, tolerance_));
    }
    vertices_ += points.size();
    clip::Path ring;
    for (const Vec2& p : points) {
      const clip::IntPoint at = lattice->snap(p);
      if (ring.empty() || ring.back() != at) ring.push_back(at);
    }
    all.push_back(std::move(ring));
  }
  return all;
}

std::vector<Piece> Merger::unite(const std::vector<clip::Paths>& filled) const {
  clip::Clipper clipper(clip::ioStrictlySimple);
  for (const clip::Paths& paths : filled) clipper.AddPaths(paths, clip::ptSubject, true);
  clip::PolyTree tree;
  clipper.Execute(clip::ctUnion, tree, clip::pftNonZero, clip::pftNonZero);
  std::vector<Piece> pieces;
  for (const clip::PolyNode* node = tree.GetFirst(); node != nullptr; node = node->GetNext()) {
    if (node->IsHole() || isSpeck(node->Contour)) continue;
    pieces.push_back({node->Contour, {}});
    for (const clip::PolyNode* hole : node->Childs)
      if (!isSpeck(hole->Contour)) pieces.back().holes.push_back(hole->Contour);
  }
  return pieces;
}

/// The elements with a vertex in the piece or on it.
std::vector<std::size_t> Merger::elementsIn(const Piece& piece, const std::vector<clip::Paths>& filled) const {
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < filled.size(); ++i) {
    const bool within = std::any_of(filled[i].begin(), filled[i].end(), [&](const clip::Path& path) {
      return clip::PointInPolygon(path.front(), piece.outer) != 0;
    });
    if (within) found.push_back(i);
  }
  return found;
}

std::string Merger::names(const std::vector<std::size_t>& elements) const {
  std::string all;
  for (const std::size_t i : elements) {
    all += fmt::format("{}{} ({})", all.empty() ? "" : " with ", elements_[i].name, elements_[i].place);
    if (all.size() > 200) return all + " …";
  }
  return all;
}

Polygon Merger::build(const Piece& piece, const Lattice& lattice, const std::string& whose,
                      std::vector<std::string>* notes) const {
  std::size_t crossings = 0;
  const auto points = [&](const clip::Path& path, bool asDrawn) {
    std::vector<Vec2> ring;
    for (const clip::IntPoint& p : path) {
      const Vec2* vertex = lattice.vertex(p);
      crossings += vertex == nullptr;
      ring.push_back(asDrawn && vertex != nullptr ? *vertex : lattice.point(p));
    }
    return ring;
  };
  const auto make = [&](bool asDrawn) {
    crossings = 0;
    std::vector<std::vector<Vec2>> holes;
    for (const clip::Path& hole : piece.holes) holes.push_back(points(hole, asDrawn));
    Polygon polygon = Polygon::make(points(piece.outer, asDrawn), std::move(holes));
    if (notes != nullptr && crossings > 0)
      notes->push_back(fmt::format("{}: outlines cross; {} of these points lie on a lattice of {:.2g} m", name_,
                                   crossings, lattice.unit()));
    return polygon;
  };
  try {
    return make(true);
  } catch (const PolygonError&) {
    // Half a spacing was enough to make outlines meet. On the lattice, where they were united, they may not.
  }
  try {
    return make(false);
  } catch (const PolygonError& error) {
    throw DrawingError(fmt::format("{}: {}: {}", name_, whose, error.what()));
  }
}

Polygon Merger::polygon(std::vector<std::string>* notes) {
  const Box box = bounds();
  const double size = box.empty() ? 0.0 : box.size().maxCoeff();
  const std::string first = fmt::format("{}: {}", elements_.front().place, elements_.front().name);
  if (!(size > 1e-12 * std::max(box.min.cwiseAbs().maxCoeff(), box.max.cwiseAbs().maxCoeff())) || !(size > 1e-100))
    throw DrawingError(fmt::format("{}: has no area, right is an outline that encloses some", first));
  if (tolerance_ == 0.0) tolerance_ = kDefaultTolerance * size;
  Lattice lattice(box);
  std::vector<clip::Paths> drawn, filled;
  for (const DrawnElement& element : elements_) drawn.push_back(rings(element, &lattice));
  if (crossMoreOften(drawn, kMostCrossings))
    throw DrawingError(
        fmt::format("{}: outlines cross more than {} times, right is a simpler drawing, or the id of a "
                    "part of it",
                    first, kMostCrossings));
  for (std::size_t i = 0; i < elements_.size(); ++i) {
    const DrawnElement& element = elements_[i];
    const clip::PolyFillType rule = element.evenOdd ? clip::pftEvenOdd : clip::pftNonZero;
    clip::Paths simple;
    clip::Clipper clipper(clip::ioStrictlySimple);
    clipper.AddPaths(drawn[i], clip::ptSubject, true);
    clipper.Execute(clip::ctUnion, simple, rule, rule);
    std::erase_if(simple, isSpeck);
    if (simple.empty() && notes != nullptr && elements_.size() > 1)
      notes->push_back(fmt::format("{}: {}: has no area and was left out", element.place, element.name));
    filled.push_back(std::move(simple));
  }
  const std::vector<Piece> pieces = unite(filled);
  if (pieces.empty())
    throw DrawingError(
        fmt::format("{}: has no area at a tolerance of {:.3g} m{}, right is an outline that encloses some", first,
                    tolerance_, elements_.size() > 1 ? ", nor has any other element" : ""));
  if (pieces.size() == 1) return build(pieces.front(), lattice, names(elementsIn(pieces.front(), filled)), notes);
  std::vector<std::vector<std::size_t>> owners;
  for (const Piece& piece : pieces) owners.push_back(elementsIn(piece, filled));
  std::sort(owners.begin(), owners.end());
  std::string list;
  for (std::size_t i = 0; i < owners.size() && i < 5; ++i) list += "; " + names(owners[i]);
  throw DrawingError(fmt::format("{}: {} separate outlines{}{}; a shape is one polygon, right is the id of one of them",
                                 name_, owners.size(), list, owners.size() > 5 ? "; …" : ""));
}

}  // namespace

Polygon svgPolygonOf(const std::string& text, const std::string& name, const std::string& id, double scale,
                     double tolerance, std::vector<std::string>* notes) {
  const std::vector<DrawnElement> elements = readDrawing(text, name, id, scale, notes);
  try {
    return Merger(elements, name, tolerance).polygon(notes);
  } catch (const clip::clipperException& error) {
    throw DrawingError(
        fmt::format("{}: its outlines cannot be united ({}), right is a simpler drawing", name, error.what()));
  }
}

Polygon svgPolygon(const std::string& path, const std::string& id, double scale, double tolerance,
                   std::vector<std::string>* notes) {
  return svgPolygonOf(readFile(path), path, id, scale, tolerance, notes);
}

}  // namespace froude::scene
