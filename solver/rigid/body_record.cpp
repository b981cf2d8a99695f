#include <froude/solver/rigid/body_record.h>

#include <cstring>

#include <froude/base/error.h>

namespace froude {
namespace {

class Writer {
 public:
  explicit Writer(std::vector<std::byte>* bytes) : bytes_(*bytes) {}
  void raw(const void* data, std::size_t size) {
    const auto* p = static_cast<const std::byte*>(data);
    bytes_.insert(bytes_.end(), p, p + size);
  }
  void number(double v) { raw(&v, sizeof v); }
  void count(std::uint64_t v) { raw(&v, sizeof v); }
  void vector(const Vec2& v) { number(v.x()), number(v.y()); }

 private:
  std::vector<std::byte>& bytes_;
};

class Reader {
 public:
  explicit Reader(std::span<const std::byte> bytes) : bytes_(bytes) {}
  void raw(void* data, std::size_t size) {
    if (size > bytes_.size() - at_) throw Error("saved bodies: the state is damaged");
    if (size > 0) std::memcpy(data, bytes_.data() + at_, size);
    at_ += size;
  }
  double number() {
    double v = 0.0;
    raw(&v, sizeof v);
    return v;
  }
  std::uint64_t count() {
    std::uint64_t v = 0;
    raw(&v, sizeof v);
    return v;
  }
  /// A number of things that take at least `bytesEach`.
  std::size_t length(std::size_t bytesEach) {
    const std::uint64_t n = count();
    if (n > (bytes_.size() - at_) / bytesEach) throw Error("saved bodies: the state is damaged");
    return static_cast<std::size_t>(n);
  }
  Vec2 vector() {
    const double x = number();
    return {x, number()};
  }
  std::size_t at() const { return at_; }

 private:
  std::span<const std::byte> bytes_;
  std::size_t at_ = 0;
};

std::uint64_t slipCode(const std::optional<Slip>& slip) { return slip ? 1 + static_cast<std::uint64_t>(*slip) : 0; }

}  // namespace

void writeBodyRecord(const BodyDef& d, std::vector<std::byte>* bytes) {
  Writer out(bytes);
  out.count(d.name.size());
  out.raw(d.name.data(), d.name.size());
  out.count(d.shape->ringStarts().size());
  for (const std::uint32_t start : d.shape->ringStarts()) out.count(start);
  out.count(d.shape->vertices().size());
  for (const Vec2& v : d.shape->vertices()) out.vector(v);
  out.vector(d.position);
  out.vector(d.velocity);
  for (const double v : {d.angle, d.density, d.spin, d.friction, d.restitution, d.surfaceVelocity}) out.number(v);
  for (const std::uint64_t v : {static_cast<std::uint64_t>(d.motion), slipCode(d.slip), std::uint64_t{d.group},
                                std::uint64_t{d.collidesWith}, std::uint64_t{d.script.size()}}) {
    out.count(v);
  }
  out.count(d.hinge ? (d.hinge->motor ? 2 : 1) : 0);
  if (!d.hinge) return;
  out.vector(d.hinge->at);
  if (d.hinge->motor) out.vector({d.hinge->motor->speed, d.hinge->motor->torque});
}

BodyRecord readBodyRecord(std::span<const std::byte> bytes) {
  Reader in(bytes);
  BodyRecord record;
  BodyDef& d = record.definition;
  d.name.resize(in.length(1));
  in.raw(d.name.data(), d.name.size());
  std::vector<std::uint32_t> starts(in.length(sizeof(std::uint64_t)));
  for (std::uint32_t& start : starts) start = static_cast<std::uint32_t>(in.count());
  std::vector<Vec2> vertices(in.length(2 * sizeof(double)));
  for (Vec2& v : vertices) v = in.vector();
  if (starts.size() < 2 || starts.front() != 0 || starts.back() != vertices.size() ||
      !std::is_sorted(starts.begin(), starts.end())) {
    throw Error("saved bodies: the state is damaged");
  }
  d.shape = std::make_shared<const Polygon>(Polygon::restored(std::move(vertices), std::move(starts)));
  d.position = in.vector();
  d.velocity = in.vector();
  for (double* v : {&d.angle, &d.density, &d.spin, &d.friction, &d.restitution, &d.surfaceVelocity}) *v = in.number();
  d.motion = static_cast<Motion>(in.count());
  const std::uint64_t slip = in.count();
  if (slip > 0) d.slip = static_cast<Slip>(slip - 1);
  d.group = static_cast<std::uint32_t>(in.count());
  d.collidesWith = static_cast<std::uint32_t>(in.count());
  record.scriptPieces = static_cast<std::size_t>(in.count());
  if (const std::uint64_t hinge = in.count(); hinge > 0) {
    d.hinge = HingeDef{in.vector(), std::nullopt};
    if (hinge > 1) {
      const Vec2 motor = in.vector();
      d.hinge->motor = MotorDef{motor.x(), motor.y()};
    }
  }
  record.size = in.at();
  return record;
}

}  // namespace froude
