// A game's loop without a scene: a player's paddle is steered by hand, a gun shoots, water splashes, a ray aims, and
// what was hit is told after each frame.
#include <froude/solver/world.h>
#include <tbb/task_arena.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <string>
#include <vector>

namespace {

using froude::Vec2;

constexpr double kFrame = 1.0 / 60.0;  // s

void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "game: not so: %s\n", what);
  std::exit(1);
}

froude::WorldDef definition() {
  froude::WorldDef def;
  def.domain.box = {{0.0, 0.0}, {2.0, 1.5}};  // m, closed on all sides
  def.fluid = froude::FluidDef{};
  def.fluid->spacing = 0.025;
  def.bullet = froude::BulletDef{};
  def.bullet->radius = 0.005;
  def.bullet->group = 2;
  // Water stays in; what reaches the upper right corner is gone, and we are told.
  def.sinks.push_back({std::make_shared<const froude::Polygon>(froude::Polygon::box({{1.7, 1.2}, {2.0, 1.5}}))});
  return def;
}

froude::BodyDef bodyOf(const char* name, const froude::Polygon& shape, const Vec2& position) {
  froude::BodyDef def;
  def.name = name;
  def.shape = std::make_shared<const froude::Polygon>(shape);
  def.position = position;
  return def;
}

struct Outcome {
  int hits = 0, splashes = 0, crates = 0, swallowed = 0;
  std::string hash;
};

class Game {
 public:
  Game() : world_(definition()) {
    std::vector<Vec2> places;
    for (int j = 0; j < 16; ++j)
      for (int i = 0; i < 80; ++i) places.emplace_back((i + 0.5) * 0.025, (j + 0.5) * 0.025);
    world_.addFluid(places, std::vector<Vec2>(places.size(), Vec2::Zero()));

    froude::BodyDef paddle = bodyOf("paddle", froude::Polygon::box({{-0.15, -0.02}, {0.15, 0.02}}), {1.0, 0.6});
    paddle.motion = froude::Motion::Scripted;  // moved by us, frame by frame
    player_ = world_.createBody(paddle);
    for (int k = 0; k < 4; ++k) {
      crates_.push_back(world_.createBody(bodyOf("crate", froude::Polygon::regular(4, 0.06), {1.8, 0.55 + 0.15 * k})));
    }
    owner_ = world_.bullets()->addColumn<std::uint32_t>("owner", froude::ColumnKind::State);
    // A breeze that pushes bullets and not the water; it sees places, velocities and the time.
    world_.setForce([](const froude::ForcePoint& p) {
      return p.species == froude::Species::Bullet ? Vec2(-0.5 * p.v) : Vec2(0.0, 0.0);
    });
    froude::EventSettings events;
    events.bulletContacts = events.fluidContacts = events.sinks = true;
    events.slowestContact = 0.2;  // m/s: water that lies on the floor is no event
    world_.record(events);
  }

  void frame(int number) {
    steer(number);
    if (number % 3 == 0) shoot(number);
    const froude::StepReport report = world_.step(kFrame);
    require(report.ok(), "the step is sound");
    listen();
  }

  Outcome outcome() const {
    Outcome result = outcome_;
    result.hash = world_.stateHash();
    return result;
  }
  const froude::World& world() const { return world_; }

 private:
  void steer(int number) {
    const double phase = 2.0 * froude::kPi * number / 60.0;
    const Vec2 place(1.0 + 0.4 * std::sin(phase), 0.45 + 0.12 * std::cos(phase));  // it dips into the water
    world_.steerBody(player_, place, 0.5 * std::sin(phase), kFrame);
  }

  void shoot(int number) {
    const Vec2 muzzle(0.1, 0.6 + 0.02 * (number % 30));
    const froude::CollisionFilter bullets{2, ~0u};
    const froude::RayHit aim = world_.castRay(muzzle, muzzle + Vec2(1.89, 0.0), bullets);
    if (aim.hit && aim.body == player_) return;  // not at ourselves
    const auto shot = world_.addBullets(std::vector<Vec2>{muzzle}, std::vector<Vec2>{{12.0, 1.0}});
    froude::ParticlePool& pool = *world_.bullets();
    pool.column(owner_)[*pool.indexOf(shot[0])] = 1 + static_cast<std::uint32_t>(number);
  }

  void listen() {
    std::vector<froude::BodyId> broken;
    for (const froude::ContactEvent& event : world_.contacts()) {
      if (event.species == froude::Species::Fluid) {
        outcome_.splashes += event.body == player_ ? 1 : 0;
        continue;
      }
      ++outcome_.hits;
      const bool crate = !event.body.isNull() && event.body != player_;
      if (crate && event.speed > 5.0) broken.push_back(event.body);
      if (crate) world_.kill(froude::Species::Bullet, event.particle);
    }
    for (const froude::BodyId id : broken) {
      if (!world_.isAlive(id)) continue;  // two bullets in one frame
      world_.destroyBody(id);
      ++outcome_.crates;
    }
    outcome_.swallowed += static_cast<int>(world_.swallowed().size());
    // Bullets that lie in the water are taken away.
    world_.kill(froude::Species::Bullet, froude::Box{{0.0, 0.0}, {2.0, 0.3}});
  }

  froude::World world_;
  froude::BodyId player_;
  std::vector<froude::BodyId> crates_;
  froude::ColumnId<std::uint32_t> owner_;
  Outcome outcome_;
};

Outcome play(int threads, int frames) {
  tbb::task_arena arena(threads);  // ours: the library uses it and asks for no other
  return arena.execute([&] {
    Game game;
    for (int number = 0; number < frames; ++number) game.frame(number);
    const froude::ParticlePool& bullets = *game.world().bullets();
    const auto owner = bullets.column(*bullets.findColumn<std::uint32_t>("owner"));
    for (std::size_t i = 0; i < bullets.size(); ++i) require(owner[i] % 3 == 1, "every bullet knows who shot it");
    require(game.world().ledger().leaks == 0, "nothing leaks");
    return game.outcome();
  });
}

}  // namespace

int main() {
  const Outcome one = play(1, 90), two = play(2, 90);
  require(one.hash == two.hash, "the same bits on one thread and on two");
  require(one.hits > 10, "bullets hit");
  require(one.crates > 0, "crates break");
  require(one.splashes > 0, "water splashes on the paddle");
  try {
    Game game;
    game.frame(0);
    froude::World other(definition());
    other.destroyBody(froude::BodyId{3, 1});
    require(false, "a stale id is refused");
  } catch (const froude::Error& error) {
    std::printf("refused: %s\n", error.what());
  }
  std::printf("%d hits, %d crates broken, %d splashes on the paddle, %d swallowed, state %s\n", one.hits, one.crates,
              one.splashes, one.swallowed, one.hash.c_str());
}
