// Ropes: the elastica under its own weight, hanging chains, a load a thousand times as heavy as its
// rope.
#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "validation/soft_point.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

constexpr double kReadFrom = 0.9;  // of the run: means at rest are taken from here on

/// Where the end of a strip of length 1 comes to rest, against the elastica (by shooting).
class Bent final : public Measure {
 public:
  Bent(const scene::Scene& scene, const Vec2& exact)
      : from_(kReadFrom * scene.duration), tip_(scene, 0, {1.0, 0.0}), exact_(exact) {}
  void read(const World& world, double t) override {
    if (t < from_) return;
    sum_ += tip_.displacement(world);
    count_ += 1.0;
  }
  std::vector<Metric> results() const override {
    const Vec2 off = sum_ / count_ - exact_;
    return {{"back", "1", off.x() / exact_.x(), 0.03}, {"down", "1", off.y() / exact_.y(), 0.03}};
  }

 private:
  double from_;
  SoftPoint tip_;
  Vec2 exact_, sum_{0, 0};
  double count_ = 0.0;
};

/// Joints of a chain, from a table of their places at rest.
std::vector<Vec2> jointsOf(int links) {
  const std::string file = dataPath("soft_chain_links.csv");
  std::ifstream stream(file);
  std::vector<Vec2> joints;
  for (std::string line; std::getline(stream, line);) {
    std::stringstream cells(line);
    std::vector<double> row;
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::atof(cell.c_str()));
    if (row.size() == 8 && row[0] == links) joints.emplace_back(row[6], row[7]);
  }
  if (joints.size() != static_cast<std::size_t>(links) + 1) throw Error(file + " has no such chain");
  return joints;
}

/// Largest distance of a point from its place at rest, over the length of the chain.
class Hanging final : public Measure {
 public:
  /// `place(s)`: where the point at the share s of the length is to be.
  Hanging(double length, std::function<Vec2(double s)> place) : length_(length), place_(std::move(place)) {}
  void read(const World& world, double) override {
    const std::size_t n = world.soft()->size();
    furthest_ = 0.0;
    for (std::uint32_t k = 0; k < n; ++k) {
      const Vec2 exact = place_(k / static_cast<double>(n - 1));
      furthest_ = std::max(furthest_, (softPoint(world, 0, k) - exact).norm() / length_);
    }
    stretch_ = largestStretch(world, 0);
  }
  std::vector<Metric> results() const override {
    return {{"place", "1", furthest_, 0.01}, {"stretch", "1", stretch_, 0.01, false}};
  }

 private:
  double length_;
  std::function<Vec2(double)> place_;
  double furthest_ = 0.0, stretch_ = 0.0;
};

/// y = a cosh((x − ½)/a) + y0 of length 2 between (0, 0) and (1, 0).
Vec2 catenary(double s) {
  constexpr double a = 0.2296402151, y0 = -1.026028571;
  const double x = a * std::asinh((2.0 * s - 1.0) / a);
  return {0.5 + x, a * std::cosh(x / a) + y0};
}

class HeavyBox final : public Measure {
 public:
  void read(const World& world, double t) override {
    if (t > 0.0) worst_ = std::max(worst_, largestStretch(world, 0));
    last_ = largestStretch(world, 0);
    box_ = world.body(0).transform.position.y();
  }
  std::vector<Metric> results() const override {
    return {{"stretch", "1", worst_, 0.05, false},
            {"stretch_at_rest", "1", last_, 0.05, false},
            {"dropped", "1", box_ > 0.5 ? 0.0 : 1.0, 0.0, false}};
  }

 private:
  double worst_ = 0.0, last_ = 0.0, box_ = 0.0;
};

// A strip of L = 1 m, h = 0.02 m, E = 3.75e6: EI = 2.5 N·m.
const Registered kWeight{
    {.name = "elastica_weight",
     .measures = "a strip bent by its own weight, w L³/EI = 8: the elastica, by shooting",
     .scene = "elastica",
     .every = 0.02,
     .full = {{0.05, 0.025, 0.0125}, {}},
     .quick = {{0.1}, {{"duration", "1.0"}}},
     .measure = [](const scene::Scene& s) { return std::make_unique<Bent>(s, Vec2(-0.2755742675, -0.6406307174)); },
     .softModels = {"rope"},
     .flow = FlowKind::Soft,
     .norm = {"back", "down"}}};

// The same as triangles: plane strain, EI = E/(1 − ν²) h³/12, ν = 0.3, h = 0.05: E as for the rope, at 6.25 times the
// weight.
const std::string kStrip =
    "[{ name = \"strip\", shape = { box = [0.0, -0.025, 1.0, 0.025] }, density = 1000.0, young = 5.46e5, poisson = "
    "0.3, "
    "damping = 2.5, pin = { box = [-0.01, -0.03, 0.0, 0.03] } }]";
const Registered kTriangles{
    {.name = "elastica_triangles",
     .measures = "the same as a body of triangles, L/h = 20",
     .scene = "elastica",
     .every = 0.02,
     .full = {{0.05 / 3, 0.05 / 6}, {{"soft", kStrip}}},
     .quick = {{0.05}, {{"soft", kStrip}, {"duration", "1.0"}}},
     .measure = [](const scene::Scene& s) { return std::make_unique<Bent>(s, Vec2(-0.2755742675, -0.6406307174)); },
     .softModels = {"neo-hookean", "stvk"},
     .flow = FlowKind::Soft,
     .norm = {"back", "down"}}};

const Registered kBeads{{.name = "bead_chain",
                         .measures = "ten links of 0.2 m between points 1 m apart: exact balance of each joint",
                         .scene = "chain",
                         .every = 0.1,
                         .full = {{0.2}, {}},
                         .quick = {{0.2}, {{"duration", "0.5"}}},
                         .measure =
                             [](const scene::Scene&) {
                               const std::vector<Vec2> joints = jointsOf(10);
                               return std::make_unique<Hanging>(2.0, [joints](double s) {
                                 return joints[static_cast<std::size_t>(std::lround(10.0 * s))];
                               });
                             },
                         .softModels = {"rope"},
                         .flow = FlowKind::Soft,
                         .norm = {"place"}}};

const Registered kChain{{.name = "hanging_chain",
                         .measures = "a chain of length 2 between points 1 m apart: the catenary",
                         .scene = "chain",
                         .every = 0.1,
                         .full = {{0.1, 0.05, 0.025}, {}},
                         .quick = {{0.1}, {{"duration", "0.5"}}},
                         .measure = [](const scene::Scene&) { return std::make_unique<Hanging>(2.0, catenary); },
                         .softModels = {"rope"},
                         .flow = FlowKind::Soft,
                         .norm = {"place"}}};

const Registered kHeavy{{.name = "heavy_box",
                         .measures = "a box on a rope of a thousandth of its mass: the largest stretch of a link",
                         .scene = "heavy_box",
                         .every = 0.01,
                         .full = {{0.02}, {}},
                         .quick = {{0.05}, {{"duration", "0.2"}}},
                         .measure = [](const scene::Scene&) { return std::make_unique<HeavyBox>(); },
                         .softModels = {"rope"},
                         .flow = FlowKind::Soft,
                         .norm = {"stretch"}}};

}  // namespace
}  // namespace froude::validation
