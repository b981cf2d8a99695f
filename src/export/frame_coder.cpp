#include "export/frame_coder.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <numeric>

#include <froude/base/parallel.h>
#include "export/color_scale.h"
#include "export/frames.h"
#include "export/soft_surface.h"

namespace froude::exporting {
namespace {

constexpr std::uint32_t kMagic = 0x47505246;  // "FRPG"
constexpr std::uint32_t kStep = 1, kBeside = 2, kValues = 4;
constexpr double kLargest16 = 65535.0;
// Residuals are noise to a search for repeats: entropy coding and runs are as small and several times as fast.
constexpr int kStrategy = Z_RLE, kLevel = 6;

template <typename T>
void put(std::string& out, T value) {
  static_assert(std::endian::native == std::endian::little);
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  out.append(bytes, sizeof value);
}

template <typename T>
T take(const char* bytes) {
  T value;
  std::memcpy(&value, bytes, sizeof value);
  return value;
}

void putVarint(std::string& out, std::uint32_t value) {
  for (; value >= 0x80; value >>= 7) out += static_cast<char>(value | 0x80);
  out += static_cast<char>(value);
}

std::uint32_t zigzag32(std::uint32_t difference) {
  return (difference << 1) ^ (difference >> 31 != 0 ? 0xffffffffu : 0u);
}

std::uint16_t zigzag16(std::uint16_t difference) {
  return static_cast<std::uint16_t>((difference << 1) ^ (difference >> 15 != 0 ? 0xffff : 0));
}

/// One coordinate of all particles against one of the four predictions.
void residuals(const std::vector<std::uint16_t>& now, const std::vector<std::uint16_t>& before,
               const std::vector<std::uint16_t>& step, std::uint32_t flags, std::vector<std::uint16_t>& out) {
  out.resize(now.size());
  std::uint16_t beside = 0;
  for (std::size_t i = 0; i < now.size(); ++i) {
    auto r = static_cast<std::uint16_t>(now[i] - before[i]);
    if ((flags & kStep) != 0) r = static_cast<std::uint16_t>(r - step[i]);
    out[i] = zigzag16(static_cast<std::uint16_t>(r - ((flags & kBeside) != 0 ? beside : 0)));
    beside = r;
  }
}

std::uint64_t bits(const std::vector<std::uint16_t>& residual) {
  std::uint64_t sum = 0;
  for (const std::uint16_t r : residual) sum += static_cast<std::uint64_t>(std::bit_width(r));
  return sum;
}

void putPlanes(std::string& out, const std::vector<std::uint16_t>& values) {
  for (const int shift : {0, 8})
    for (const std::uint16_t v : values) out += static_cast<char>(v >> shift);
}

void putDifferences(std::string& out, const std::vector<std::uint8_t>& now, const std::vector<std::uint8_t>& before) {
  for (std::size_t i = 0; i < now.size(); ++i) out += static_cast<char>(now[i] - before[i]);
}

void putIndices(std::string& out, const std::vector<std::uint32_t>& indices) {
  std::uint32_t last = 0;
  for (const std::uint32_t i : indices) {
    putVarint(out, zigzag32(i - last));
    last = i;
  }
}

template <typename T>
void reorder(std::vector<T>& values, const std::vector<std::uint32_t>& order) {
  if (values.empty()) return;
  std::vector<T> sorted(values.size());
  for (std::size_t i = 0; i < order.size(); ++i) sorted[i] = values[order[i]];
  values.swap(sorted);
}

void sortById(CoarseFrame::Particles& p) {
  if (std::is_sorted(p.id.begin(), p.id.end())) return;
  std::vector<std::uint64_t> keys(p.id.size());
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = static_cast<std::uint64_t>(p.id[i]) << 32 | i;
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(keys.size());
  for (std::size_t i = 0; i < keys.size(); ++i) order[i] = static_cast<std::uint32_t>(keys[i]);
  reorder(p.id, order);
  reorder(p.x, order);
  reorder(p.y, order);
  reorder(p.speed, order);
  reorder(p.value, order);
}

/// Keeps the elements of `values` at `places`, and adds zeros up to `count`.
template <typename T>
void follow(std::vector<T>& values, const std::vector<std::uint32_t>& places, std::size_t count) {
  if (count > 0 && !values.empty())
    for (std::size_t i = 0; i < places.size(); ++i) values[i] = values[places[i]];
  values.resize(std::min(count, places.size()));
  values.resize(count, T(0));
}

void fill(CoarseFrame::Particles& out, const ParticlePool& pool, const Box& box, const FrameRanges& ranges,
          double pressureScale) {
  const auto x = pool.x(), y = pool.y(), vx = pool.vx(), vy = pool.vy();
  const auto birth = pool.birth();
  const auto column = pool.findColumn<float>("pressure");
  const bool values = pressureScale > 0.0;
  const std::size_t n = pool.size();
  out.id.resize(n);
  out.x.resize(n);
  out.y.resize(n);
  out.speed.resize(n);
  out.value.resize(values ? n : 0);
  const Vec2 scale = Vec2(kLargest16, kLargest16).cwiseQuotient(box.size());
  const auto quantised = [](double place) {
    return static_cast<std::uint16_t>(std::clamp(place + 0.5, 0.0, kLargest16));
  };
  parallelFor(n, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      out.id[i] = static_cast<std::uint32_t>(birth[i]);
      out.x[i] = quantised((x[i] - box.min.x()) * scale.x());
      out.y[i] = quantised((y[i] - box.min.y()) * scale.y());
      out.speed[i] = ranges.speed.code(std::sqrt(vx[i] * vx[i] + vy[i] * vy[i]));
      if (values)
        out.value[i] =
            ranges.pressure.code(column ? pressureScale * static_cast<double>(pool.column(*column)[i]) : 0.0);
    }
  });
}

std::string compressed(const std::string& raw) {
  z_stream stream = {};
  if (deflateInit2(&stream, kLevel, Z_DEFLATED, MAX_WBITS, MAX_MEM_LEVEL, kStrategy) != Z_OK)
    throw OutputError("frames of the page: zlib could not be started");
  std::string packed(deflateBound(&stream, raw.size()), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(raw.data()));
  stream.avail_in = static_cast<uInt>(raw.size());
  stream.next_out = reinterpret_cast<Bytef*>(packed.data());
  stream.avail_out = static_cast<uInt>(packed.size());
  const int result = deflate(&stream, Z_FINISH);
  packed.resize(stream.total_out);
  deflateEnd(&stream);
  if (result != Z_STREAM_END) throw OutputError("frames of the page: zlib failed");
  return packed;
}

}  // namespace

std::uint8_t ByteRange::code(double value) const {
  const double place = (value - low) / (high - low) * 255.0 + 0.5;
  return static_cast<std::uint8_t>(place > 0.0 ? std::min(place, 255.0) : 0.0);
}

FrameRanges frameRanges(const scene::Scene& scene) {
  const ColorScale speed = colorScale(scene, "speed"), pressure = colorScale(scene, "pressure"),
                   strain = strainScale(scene);
  return {{speed.low, speed.high}, {pressure.low, pressure.high}, {strain.low, strain.high}};
}

CoarseFrame takeFrame(const World& world, const FrameRanges& ranges, int index) {
  const WorldDef& def = world.definition();
  const Box& box = def.domain.box;
  CoarseFrame frame;
  frame.index = index;
  frame.time = world.time();
  if (world.fluid() != nullptr) fill(frame.species[0], *world.fluid(), box, ranges, def.fluid->density);
  if (world.bullets() != nullptr) fill(frame.species[1], *world.bullets(), box, ranges, 0.0);
  if (world.soft() != nullptr) fill(frame.species[2], *world.soft(), box, ranges, 0.0);
  for (std::size_t b = 0; b < world.bodyCount(); ++b) {
    if (world.bodyDefinition(b).motion == Motion::Fixed) continue;
    const BodyState& body = world.body(b);
    for (const double v : {body.transform.position.x(), body.transform.position.y(), body.angle})
      frame.bodies.push_back(static_cast<float>(v));
  }
  if (world.softCount() == 0) return frame;
  const SoftSurface surface = softSurface(world);
  for (const auto& t : surface.triangles) frame.corners.insert(frame.corners.end(), t.begin(), t.end());
  for (const auto& l : surface.links) frame.ends.insert(frame.ends.end(), l.begin(), l.end());
  for (const auto* values : {&surface.strain, &surface.linkStrain})
    for (const float s : *values) frame.strain.push_back(ranges.strain.code(static_cast<double>(s)));
  return frame;
}

void FrameCoder::encodeSpecies(CoarseFrame::Particles& now, Track& track, std::string& out) {
  const std::size_t n = now.id.size();
  // Numbers of creation only rise, so those that stay keep their order, and the new ones follow.
  std::vector<std::uint32_t> stay, gone;
  std::size_t k = 0;
  for (std::size_t i = 0; i < track.id.size(); ++i) {
    const bool here = k < n && now.id[k] == track.id[i];
    (here ? stay : gone).push_back(static_cast<std::uint32_t>(i));
    if (here) ++k;
  }
  const std::size_t stayed = stay.size();
  const bool values = !now.value.empty();
  follow(track.x, stay, n);
  follow(track.y, stay, n);
  follow(track.dx, stay, n);
  follow(track.dy, stay, n);
  follow(track.speed, stay, n);
  follow(track.value, stay, values ? n : 0);

  std::vector<std::uint16_t> rx, ry, bestX, bestY;
  std::uint32_t flags = 0;
  std::uint64_t fewest = ~0ull;
  for (const std::uint32_t mode : {0u, kStep, kBeside, kStep | kBeside}) {
    residuals(now.x, track.x, track.dx, mode, rx);
    residuals(now.y, track.y, track.dy, mode, ry);
    const std::uint64_t cost = bits(rx) + bits(ry);
    if (cost >= fewest) continue;
    fewest = cost;
    flags = mode;
    bestX.swap(rx);
    bestY.swap(ry);
  }
  for (const std::size_t v : {n, gone.size(), n - stayed}) put(out, static_cast<std::uint32_t>(v));
  put(out, flags | (values ? kValues : 0u));
  std::uint32_t last = 0;
  for (const std::uint32_t place : gone) putVarint(out, place - std::exchange(last, place));
  last = 0;
  for (std::size_t i = stayed; i < n; ++i) putVarint(out, now.id[i] - std::exchange(last, now.id[i]));
  putPlanes(out, bestX);
  putPlanes(out, bestY);
  putDifferences(out, now.speed, track.speed);
  if (values) putDifferences(out, now.value, track.value);

  for (std::size_t i = 0; i < n; ++i) {
    const bool known = i < stayed;  // a new one has no last step
    track.dx[i] = known ? static_cast<std::uint16_t>(now.x[i] - track.x[i]) : 0;
    track.dy[i] = known ? static_cast<std::uint16_t>(now.y[i] - track.y[i]) : 0;
  }
  track.id.swap(now.id);
  track.x.swap(now.x);
  track.y.swap(now.y);
  track.speed.swap(now.speed);
  track.value.swap(now.value);
}

void FrameCoder::encodeBodies(const CoarseFrame& frame, std::string& out) {
  const std::size_t n = frame.bodies.size();
  bodies_.resize(n, 0u);
  std::vector<std::uint32_t> changed(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto now = std::bit_cast<std::uint32_t>(frame.bodies[i]);
    changed[i] = now ^ std::exchange(bodies_[i], now);
  }
  put(out, static_cast<std::uint32_t>(n));
  for (const int shift : {0, 8, 16, 24})
    for (const std::uint32_t bitsOfOne : changed) out += static_cast<char>(bitsOfOne >> shift);
}

void FrameCoder::encodeSurface(const CoarseFrame& frame, std::string& out) {
  const bool same = corners_ == frame.corners && ends_ == frame.ends;
  put(out, static_cast<std::uint32_t>(frame.corners.size() / 3));
  put(out, static_cast<std::uint32_t>(frame.ends.size() / 2));
  put(out, static_cast<std::uint32_t>(same ? 1 : 0));
  if (!same) {
    putIndices(out, frame.corners);
    putIndices(out, frame.ends);
    corners_ = frame.corners;
    ends_ = frame.ends;
    strain_.assign(frame.strain.size(), 0);
  }
  putDifferences(out, frame.strain, strain_);
  strain_ = frame.strain;
}

std::string FrameCoder::encode(CoarseFrame frame) {
  for (CoarseFrame::Particles& p : frame.species) sortById(p);
  bool key = count_ % kKeyEvery == 0;
  for (int s = 0; s < 3; ++s) {
    // A number that is younger than one that is gone is new; an older one would be out of order.
    const std::vector<std::uint32_t>&before = tracks_[s].id, &now = frame.species[s].id;
    if (before.empty() || now.empty()) continue;
    const auto firstNew = std::upper_bound(now.begin(), now.end(), before.back());
    if (!std::includes(before.begin(), before.end(), now.begin(), firstNew)) key = true;
  }
  if (key) *this = FrameCoder();
  ++count_;
  const std::size_t particles = frame.particles();
  std::string raw;
  raw.reserve(8 * particles + 16 * frame.strain.size() + 4 * frame.bodies.size() + 1024);
  for (int s = 0; s < 3; ++s) encodeSpecies(frame.species[s], tracks_[s], raw);
  encodeBodies(frame, raw);
  encodeSurface(frame, raw);
  const std::string packed = compressed(raw);

  std::string record;
  record.reserve(kHeaderBytes + packed.size());
  put(record, kMagic);
  put(record, static_cast<std::uint32_t>(frame.index));
  put(record, frame.time);
  for (const std::size_t v : {std::size_t{key}, raw.size(), packed.size(), particles})
    put(record, static_cast<std::uint32_t>(v));
  return record + packed;
}

bool readRecord(const char* bytes, FrameRecord& record) {
  if (take<std::uint32_t>(bytes) != kMagic) return false;
  record.index = static_cast<int>(take<std::uint32_t>(bytes + 4));
  record.time = take<double>(bytes + 8);
  record.key = take<std::uint32_t>(bytes + 16) != 0;
  record.unpacked = take<std::uint32_t>(bytes + 20);
  record.packed = take<std::uint32_t>(bytes + 24);
  record.particles = take<std::uint32_t>(bytes + 28);
  return true;
}

}  // namespace froude::exporting
