// What a soft body keeps: its area when it is pressed, its shape after it was turned inside out.
#include <algorithm>
#include <cmath>

#include <froude/base/random.h>
#include "validation/soft_point.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {

/// Area of a neo-Hookean block over that at rest, pressed to the share `height` of its height between smooth plates,
/// its sides free: μ λ₁ + (λ+μ)(J − γ) λ₂ = 0 with J = λ₁ λ₂, γ = 1 + μ/(λ+μ).
double pressedArea(const SoftDef& def, double height) {
  const double mu = def.young / (2.0 * (1.0 + def.poisson));
  const double lambda = def.young * def.poisson / ((1.0 + def.poisson) * (1.0 - 2.0 * def.poisson));
  const double stiff = lambda + mu;
  return (stiff + mu) * height * height / (mu + stiff * height * height);
}

class Pressed final : public Measure {
 public:
  void read(const World& world, double t) override {
    const double area = world.softState(0).area;
    if (t == 0.0) first_ = area;
    last_ = area;
    exact_ = pressedArea(world.softDefinition(0), 0.5);
    height_ = world.body(1).transform.position.y() - 0.1;
    double top = 0.0;
    for (const double y : world.soft()->y()) top = std::max(top, y - 0.1);
    through_ = top - height_;
  }
  std::vector<Metric> results() const override {
    return {{"area", "1", last_ / first_ / exact_ - 1.0, 0.01, false},
            {"into_plate", "m", std::max(0.0, through_), {}, false}};
  }

 private:
  double first_ = 0.0, last_ = 0.0, exact_ = 1.0, height_ = 0.0, through_ = 0.0;
};

/// Each point of each body somewhere in the body's box, at rest.
void throwAbout(World& world) {
  ParticlePool& pool = *world.soft();
  for (std::size_t body = 0; body < world.softCount(); ++body) {
    const SoftDef& def = world.softDefinition(body);
    RandomStream random(7, body);
    Box box;
    for (const Vec2& p : def.mesh->points) box.include(p);
    for (std::size_t k = 0; k < def.mesh->points.size(); ++k) {
      const std::size_t i = world.softFirst(body) + k;
      pool.x()[i] = def.position.x() + random.uniform(box.min.x(), box.max.x());
      pool.y()[i] = def.position.y() + random.uniform(box.min.y(), box.max.y());
    }
  }
}

/// Bodies with a triangle that is strained by more than a thousandth at the end.
class Recovered final : public Measure {
 public:
  void read(const World& world, double t) override {
    lost_ = inverted_ = 0.0;
    std::vector<double> strain;
    for (std::size_t body = 0; body < world.softCount(); ++body) {
      world.softStrain(body, strain);
      const double worst = *std::max_element(strain.begin(), strain.end());
      lost_ += worst > 1e-3 ? 1.0 : 0.0;
      inverted_ += worst > 1.0 ? 1.0 : 0.0;
    }
    if (t == 0.0) first_ = inverted_;
  }
  std::vector<Metric> results() const override {
    return {{"not_recovered", "1", lost_, 0.0, false},
            {"still_inverted", "1", inverted_, 0.0, false},
            {"inverted_first", "1", first_, {}, false}};
  }

 private:
  double lost_ = 0.0, inverted_ = 0.0, first_ = 0.0;
};

const Registered kPress{
    {.name = "press",
     .measures =
         "a block of ν = 0.49 is pressed to half its height: its area against that of its law, 0.944 of that at rest",
     .scene = "press",
     .every = 0.05,
     .full = {{0.04, 0.02}, {}},
     .quick = {{0.08}, {{"duration", "0.3"}}},
     .measure = [](const scene::Scene&) { return std::make_unique<Pressed>(); },
     .softModels = {"neo-hookean"}}};

const Registered kInversion{{.name = "inversion",
                             .measures = "100 discs whose points were thrown about: how many are not in shape again",
                             .scene = "untangle",
                             .every = 0.1,
                             .full = {{0.04}, {}},
                             .quick = {{0.08}, {{"duration", "0.2"}}},
                             .measure = [](const scene::Scene&) { return std::make_unique<Recovered>(); },
                             .prepare = throwAbout,
                             .softModels = {"neo-hookean", "stvk"}}};

}  // namespace
}  // namespace froude::validation
