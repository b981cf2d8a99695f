// prototype
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "validation/exact.h"
#include "validation/read_off.h"
#include "validation/validation.h"

namespace froude::validation {
namespace {
class Resting final : public Measure {
 public:
  void read(const World& world, double t) override {
    const ParticlePool& pool = *world.fluid();
    auto p = pool.column(*pool.findColumn<float>("pressure"));
    const Moments m = moments(pool);
    double sum = 0, n = 0, v2 = 0, vm = 0, skin=0; double rmax=0;
    for (std::size_t i = 0; i < pool.size(); ++i) {
      const double r = std::hypot(pool.x()[i] - m.centre.x(), pool.y()[i] - m.centre.y());
      rmax=std::max(r,rmax);
      const double s = pool.vx()[i]*pool.vx()[i] + pool.vy()[i]*pool.vy()[i];
      v2 += s; vm = std::max(vm, std::sqrt(s));
      if (r < 0.3) { sum += (double)p[i]; n += 1; } else if (r>0.42) skin=std::max(skin,(double)p[i]);
    }
    sum /= n; v2 = std::sqrt(v2 / (double)pool.size());
    if (t > 0.5) { mean_ += sum; ++count_; rms_ += v2; max_ = std::max(max_, vm); }
    if (getenv("FT_TRACE")) printf("t %.3f p %.3f skin %.2f rms %.4f max %.4f axes %.4f %.4f rmax %.4f\n", t, sum, skin, v2, vm, m.axisX(), m.axisY(), rmax);
  }
  std::vector<Metric> results() const override {
    return {{"pressure", "1", mean_ / count_ * 0.5 - 1.0, 0.05}, {"rms", "m/s", rms_ / count_, {}}, {"max", "m/s", max_, {}}};
  }
  double mean_ = 0, count_ = 0, rms_ = 0, max_ = 0;
};
class Oscil final : public Measure {
 public:
  void read(const World& world, double t) override {
    const Moments m = moments(*world.fluid());
    const double lying = (m.xx - m.yy)/(m.xx+m.yy);
    if (getenv("FT_TRACE")) printf("t %.3f lying %.4f kin %.5f\n", t, lying, m.kinetic);
    if (t>0 && last_ < 0 && lying >= 0) { double at=lastT_ + (t - lastT_) * last_ / (last_ - lying); if (first_<0) first_=at; end_=at; ++n_; }
    if (t>0 && last_ >= 0 && lying < 0) { double at=lastT_ + (t - lastT_) * last_ / (last_ - lying); if (down0_<0) down0_=at; }
    last_ = lying; lastT_ = t;
  }
  std::vector<Metric> results() const override {
    return {{"period1", "1", (first_-down0_)*2/0.9069 - 1, 0.05},{"period", "1", n_>1?(end_-first_)/(n_-1)/0.9069-1:99, 0.05}};
  }
  double last_=0,lastT_=0,first_=-1,end_=0,down0_=-1; int n_=0;
};
class Cap final : public Measure {
 public:
  explicit Cap(double theta, double dx) : theta_(theta), dx_(dx) {}
  static double height(double a) { const double s = std::sin(a), area = a - s * std::cos(a); return (-std::cos(a) + 2.0 / 3.0 * s * s * s / area) / std::sqrt(area); }
  void read(const World& world, double t) override {
    const ParticlePool& pool = *world.fluid();
    const double area = (double)pool.size() * dx_ * dx_;
    const Moments m = moments(pool);
    double lo = 0.01, hi = 3.14;
    for (int k = 0; k < 50; ++k) { double mid = 0.5 * (lo + hi); (height(mid) < m.centre.y() / std::sqrt(area) ? lo : hi) = mid; }
    angle_ = lo * 180 / 3.14159265;
    double w=0, top=0; for (std::size_t i=0;i<pool.size();++i) { top=std::max(top,pool.y()[i]); if (pool.y()[i]<dx_) w=std::max(w,std::abs(pool.x()[i])); }
    top += 0.5*dx_; w+=0.5*dx_;
    if (getenv("FT_TRACE")) printf("t %.3f angle %.2f  from top/base %.2f rms %.5f\n", t, angle_, 2*std::atan(top/w)*180/3.14159265, std::sqrt(2*m.kinetic));
  }
  std::vector<Metric> results() const override { return {{"angle", "deg", angle_ - theta_, 5.0}}; }
  double theta_, dx_, angle_ = 0;
};
const Registered kCap{{.name = "contact_angle", .measures = "x", .scene = "contact_angle", .every = 0.2,
  .full = {{0.05, 0.025}, {}}, .quick = {{0.05}, {}}, .measure = [](const scene::Scene& s) { return std::make_unique<Cap>(s.world.fluid->contactAngle*180/3.14159265,s.world.fluid->spacing); }}};
const Registered kCap2{{.name = "contact_angle_120", .measures = "x", .scene = "contact_angle", .every = 0.2,
  .full = {{0.05, 0.025}, {{"fluid.contact_angle","120.0"}}}, .quick = {{0.05}, {{"fluid.contact_angle","120.0"}}}, .measure = [](const scene::Scene& s) { return std::make_unique<Cap>(s.world.fluid->contactAngle*180/3.14159265,s.world.fluid->spacing); }}};
const Registered kRest{{.name = "surface_tension", .measures = "x", .scene = "surface_tension", .every = 0.02,
  .full = {{0.05, 0.025, 0.0125}, {}}, .quick = {{0.05}, {}}, .measure = [](const scene::Scene&) { return std::make_unique<Resting>(); }}};
const Registered kOsc{{.name = "oscillating_drop", .measures = "x", .scene = "oscillating_drop", .every = 0.01,
  .full = {{0.05, 0.025, 0.0125}, {{"duration","2.0"}}}, .quick = {{0.05}, {{"duration","2.0"}}}, .measure = [](const scene::Scene&) { return std::make_unique<Oscil>(); }}};
}
}
