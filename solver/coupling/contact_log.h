// Contacts that particles made with obstacles in a parallel loop, kept by block so that their sums do not depend on
// threads.
#pragma once

#include <vector>

#include <froude/base/aligned.h>
#include <froude/base/parallel.h>
#include <froude/solver/coupling/particle_path.h>
#include <froude/solver/step_context.h>

namespace froude {

/// One contact: what a particle's velocity changed by.
struct LoggedContact {
  int body = -1;
  std::uint32_t particle = 0;             // index at the time of the log
  double atX = 0.0, atY = 0.0;            // [m]
  double changeX = 0.0, changeY = 0.0;    // [m/s]
  double surfaceX = 0.0, surfaceY = 0.0;  // velocity of the obstacle's surface there [m/s]
  double normalX = 0.0, normalY = 0.0;
  double approach = 0.0;  // [m/s]
  double time = 0.0;      // fraction of the sub-step
};

/// Lists of contacts, one for each block of kBlockSize particles. Memory is reused.
class ContactLog {
 public:
  void begin(std::size_t particles) {
    used_ = blockCount(particles);
    if (blocks_.size() < used_) blocks_.resize(used_);
    for (std::size_t b = 0; b < used_; ++b) {
      blocks_[b].reserve(kBlockSize / 4);  // at once, so that a splash on a wall allocates nothing
      blocks_[b].clear();
    }
  }
  /// Adds all contacts of a path; `particle` picks the block.
  void add(std::size_t particle, const PathResult& path) {
    for (int k = 0; k < path.contacts; ++k) {
      const PathResult::Impulse& p = path.impulses[static_cast<std::size_t>(k)];
      add(particle, p, p.change);
    }
  }
  /// Adds what contacts did to the mean velocity of the path, for methods that take velocities from positions: the sum
  /// of what is added is exactly (end − start)/dt − v.
  void addMean(std::size_t particle, const PathResult& path, const Vec2& start, const Vec2& v, double dt) {
    if (path.contacts == 0) return;
    Vec2 rest = (path.x - start) / dt - v;
    for (int k = 0; k + 1 < path.contacts; ++k) {
      const PathResult::Impulse& p = path.impulses[static_cast<std::size_t>(k)];
      const Vec2 change = (1.0 - p.time) * p.change;
      add(particle, p, change);
      rest -= change;
    }
    const PathResult::Impulse& last = path.impulses[static_cast<std::size_t>(path.contacts - 1)];
    add(particle, last, rest);
  }
  /// Books what the particles, each of `mass` [kg/m], gave to the obstacles, and tells the recorder if there is one.
  /// Precondition: the particles have the indices that they had when they were logged.
  void book(double mass, ImpulseLedger& impulses) const {
    forEach([&](const LoggedContact& c) {
      impulses.add(c.body, {c.atX, c.atY}, -mass * Vec2(c.changeX, c.changeY), {c.surfaceX, c.surfaceY});
    });
    if (ContactRecorder* recorder = impulses.recorder()) {
      forEach([&](const LoggedContact& c) {
        recorder->add({c.particle, c.body, {c.atX, c.atY}, {c.normalX, c.normalY}, c.approach, c.time});
      });
    }
  }
  /// visit(const LoggedContact&) in block order.
  template <typename Visit>
  void forEach(Visit&& visit) const {
    for (std::size_t b = 0; b < used_; ++b) {
      for (const LoggedContact& c : blocks_[b]) visit(c);
    }
  }
  std::size_t size() const {
    std::size_t n = 0;
    for (std::size_t b = 0; b < used_; ++b) n += blocks_[b].size();
    return n;
  }

 private:
  void add(std::size_t particle, const PathResult::Impulse& p, const Vec2& change) {
    blocks_[particle / kBlockSize].push_back({p.body, static_cast<std::uint32_t>(particle), p.at.x(), p.at.y(),
                                              change.x(), change.y(), p.surfaceVelocity.x(), p.surfaceVelocity.y(),
                                              p.normal.x(), p.normal.y(), p.approach, p.time});
  }

  std::vector<AlignedArray<LoggedContact>> blocks_;
  std::size_t used_ = 0;
};

}  // namespace froude
