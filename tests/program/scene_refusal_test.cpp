// Every way in which a scene can be wrong is refused at its place, by its key, in words.
#include <gtest/gtest.h>

#include "program/scene_support.h"

namespace froude {
namespace {

using froude::testing::kFluid;
using froude::testing::kHead;
using froude::testing::refusal;
using froude::testing::SceneFile;

struct Case {
  std::string text;
  std::string start;     // how the refusal begins, place and key included
  std::string contains;  // and what it must say
};

void expectRefusals(const std::vector<Case>& cases) {
  for (const Case& c : cases) {
    SCOPED_TRACE(c.text);
    const std::string got = refusal(c.text);
    EXPECT_EQ(got.substr(0, c.start.size()), c.start) << got;
    EXPECT_NE(got.find(c.contains), std::string::npos) << got;
  }
}

TEST(SceneRefusal, a_file_that_is_missing_a_folder_empty_or_not_TOML) {
  const auto what = [](const std::string& file) {
    try {
      scene::load(file);
    } catch (const scene::SceneError& error) {
      return std::string(error.what());
    }
    return std::string("accepted");
  };
  EXPECT_EQ(what("/no/such/scene.toml"),
            "/no/such/scene.toml:0:0: file: there is no such file, right is the path of a scene (.toml)");
  EXPECT_EQ(what("/tmp"), "/tmp:0:0: file: is a folder, right is a scene (.toml)");
  expectRefusals({{"", "1:1: format: ", "empty"},
                  {" \n\n\t", "1:1: format: ", "empty"},
                  {"format = 1\nwhat is this\n", "2:6: TOML: not a TOML document", ""},
                  {"format = 1\nformat = 1\n", "2:", "redefine"},
                  {std::string("\x89PNG\r\n\x1a\n\0\0", 10), "1:1: TOML", ""},
                  {"# only a comment\n", "1:1: format: is missing", ""}});
}

TEST(SceneRefusal, keys_of_the_first_lines) {
  expectRefusals({
      {"format = 2\n", "1:10: format: is 2, right is an integer from 1 to 1", ""},
      {"format = 1.0\n", "1:10: format: ", "integer"},
      {"format = 1\n[domain]\nbox = [0, 0, 1, 1]\n", "1:1: duration: is missing", "number above 0"},
      {"format = 1\nduration = 0\n", "2:12: duration: is 0", "above 0"},
      {"format = 1\nduration = -1.5\n", "2:12: duration: is -1.5", "above 0"},
      {"format = 1\nduration = nan\n", "2:12: duration: is nan", ""},
      {"format = 1\nduration = inf\n", "2:12: duration: is inf", ""},
      {"format = 1\nduration = 1e300\n", "2:12: duration: is 1e+300", "at most"},
      {"format = 1\nduration = \"2 s\"\n", "2:12: duration: is a string", "a number"},
      {"format = 1\nduration = 2020-01-01\n", "2:12: duration: is a date or time", ""},
      {"format = 1\nduraton = 1.0\n", "2:1: duraton: unknown key", "the nearest is \"duration\""},
      {"format = 1\nseed = -1\n", "2:8: seed: is -1", "from 0"},
      {"format = 1\ntitle = 3\n", "2:9: title: is an integer", "a string"},
      {"format = 1\nduration = 1\naccuracy = \"5%\"\n", "3:12: accuracy: ", "not in this version"},
      {"format = 1\nduration = 1\ngravity = [0.0]\n", "3:11: gravity: is an array of 1", "[x, y]"},
      {"format = 1\nduration = 1\ngravity = [0, true]\n", "3:15: gravity: is a boolean", "expression"},
      {"format = 1\nduration = 1\ngravity = [0, nan]\n", "3:15: gravity: is nan", ""},
      {"format = 1\nduration = 1\ngravity = [0, \"-9.81*z\"]\n", "3:15: gravity: \"-9.81*z\": Unexpected token \"z\"",
       "x, y, t"},
      {"format = 1\nduration = 1\ngravity = [0, \"sin(\"]\n", "3:15: gravity: ", "sin("},
  });
}

TEST(SceneRefusal, the_domain) {
  const std::string head = "format = 1\nduration = 1\n";
  expectRefusals({
      {head, "1:1: domain: is missing", "box = [xmin, ymin, xmax, ymax]"},
      {head + "domain = 3\n", "3:10: domain: is an integer, right is a table", ""},
      {head + "[domain]\nbx = [0, 0, 1, 1]\n", "4:1: domain.bx: unknown key", "\"box\""},
      {head + "[domain]\n", "3:1: domain.box: is missing", ""},
      {head + "[domain]\nbox = [0, 0, 1]\n", "4:7: domain.box: is an array of 3", "xmax"},
      {head + "[domain]\nbox = [1, 0, 0, 1]\n", "4:7: domain.box: is [1, 0, 0, 1]", "xmin < xmax"},
      {head + "[domain]\nbox = [0, 0, 1, inf]\n", "4:17: domain.box: is inf", ""},
      {head + "[domain]\nbox = [0, 0, 1e12, 1]\n", "4:14: domain.box: is 1e+12", "1000000000"},
      {kHead + "walls = [\"left\", \"up\"]\n", "5:18: domain.walls: holds \"up\"", "\"top\""},
      {kHead + "walls = [\"left\", \"left\"]\n", "5:18: domain.walls: ", "twice"},
      {kHead + "walls = \"all\"\n", "5:9: domain.walls: is a string", "true, false or a list"},
      {kHead + "wall_slip = \"none\"\n", "5:13: domain.wall_slip: is \"none\"", "\"free\""},
      {kHead + "periodic = [\"z\"]\n", "5:13: domain.periodic: ", "\"x\" or \"y\""},
      {kHead + "periodic = [\"x\"]\nwalls = [\"left\"]\n", "6:9: domain.walls: \"left\" is a periodic side", ""},
  });
}

TEST(SceneRefusal, the_model_and_the_fluid) {
  expectRefusals({
      {kHead + "[model]\nfluid = \"pfb\"\n", "6:9: model.fluid: is \"pfb\"", "\"pbf\""},
      {kHead + "[model]\nfluid = \"wcsph\"\nsupport = 1\n", "7:11: model.support: is 1", ""},
      {kHead + "[model]\nfluid = \"wcsph\"\nequation_of_state = \"ideal\"\n",
       "7:21: model.equation_of_state: is \"ideal\"", "\"tait\""},
      {kHead + "[model]\nsound_speed = 10\n", "6:15: model.sound_speed: a key of wcsph alone", "wcsph"},
      {kHead + "[model]\ntime_step = 0.0\n", "6:13: model.time_step: is 0", "above 0"},
      {kHead + "[model]\ntime_step = -1e-3\n", "6:13: model.time_step: is -0.001", "above 0"},
      {kHead + "[model]\nspacing = 0\n", "6:11: model.spacing: is 0", ""},
      {kHead + "[model]\nsweeps = 0\n", "6:10: model.sweeps: is 0", "from 1 to 1000"},
      {kHead + "[model]\nsweeps = 2.5\n", "6:10: model.sweeps: is 2.5", "an integer"},
      {kHead + "[model]\ncourant = 3\n", "6:11: model.courant: is 3", "at most 1"},
      {kHead + "[model]\nviscosity_solver = \"implict\"\n", "6:20: model.viscosity_solver: is \"implict\"",
       "\"implicit\""},
      {kHead + "[model]\nviscosity_solver = true\n", "6:20: model.viscosity_solver: ", "\"auto\""},
      {kHead + "[model]\nspacin = 0.1\n", "6:1: model.spacin: unknown key", "\"spacing\""},
      {kHead + "[fluid]\ndensity = 0\n", "6:11: fluid.density: is 0", "above 0"},
      {kHead + "[fluid]\nviscosity = -1\n", "6:13: fluid.viscosity: is -1", ""},
      {kHead + "[fluid]\nsurface_tension = -0.07\n", "6:19: fluid.surface_tension: is -0.07", ""},
      {kHead + "[fluid]\ncontact_angle = 200\n", "6:17: fluid.contact_angle: is 200", "180"},
      {kHead + "[fluid]\n[fluid]\n", "6:", "one fluid per scene"},
      {kHead + "[[fluid]]\n[[fluid]]\n", "6:1: fluid: a second fluid", "one fluid per scene"},
  });
}

TEST(SceneRefusal, blocks_of_fluid) {
  const std::string block = kHead + "[model]\nspacing = 0.1\n[[fluid.block]]\n";  // the block's header is line 7
  expectRefusals({
      {block, "7:1: fluid.block.0.shape: is missing", ""},
      {block + "shape = { box = [0, 0, 1, 0] }\n", "8:17: fluid.block.0.shape.box: is [0, 0, 1, 0]", "ymin < ymax"},
      {block + "shape = {}\n", "8:9: fluid.block.0.shape: names no shape", "\"box\""},
      {block + "shape = { bx = [0, 0, 1, 1] }\n", "8:11: fluid.block.0.shape.bx: unknown key", "\"box\""},
      {block + "shape = { box = [0, 0, 1, 1], regular = { sides = 3, radius = 1 } }\n",
       "8:41: fluid.block.0.shape.regular: a second kind of shape", ""},
      {block + "shape = { svg = { file = \"a.svg\" } }\n", "8:17: fluid.block.0.shape.svg: ", "there is no such file"},
      {block + "shape = { box = [0, 0, 1, 1], holes = [] }\n",
       "8:39: fluid.block.0.shape.holes: holes belong to a polygon", ""},
      {block + "shape = { regular = { sides = 2, radius = 1 } }\n", "8:31: fluid.block.0.shape.regular.sides: is 2",
       "from 3"},
      {block + "shape = { regular = { sides = 5 } }\n", "8:21: fluid.block.0.shape.regular.radius: is missing", ""},
      {block + "shape = { polygon = [[0, 0], [1, 1], [1, 0], [0, 1]] }\n",
       "8:21: fluid.block.0.shape.polygon: ", "cross"},
      {block + "shape = { polygon = [[0, 0], [1, 1], [2, 2]] }\n", "8:21: fluid.block.0.shape.polygon: ", ""},
      {block + "shape = { polygon = [[0, 0], [1, 1, 1], [1, 0]] }\n",
       "8:30: fluid.block.0.shape.polygon: vertex 1 is no pair", ""},
      {block + "shape = { polygon = [[0, 0], [1, nan], [1, 0]] }\n",
       "8:34: fluid.block.0.shape.polygon: vertex 1 holds nan", ""},
      {block + "shape = { polygon = [[0, 0], [1, 0], [1, 1]], holes = [[[5, 5], [6, 5], [6, 6]]] }\n",
       "8:21: fluid.block.0.shape.polygon: ", "hole"},
      {block + "shape = { box = [0.0, 0.0, 0.05, 1.0] }\n",
       "8:9: fluid.block.0.shape: is 0.05 m × 1 m, smaller than the spacing", "at most 0.05"},
      {block + "shape = { box = [5, 5, 6, 6] }\n", "8:9: fluid.block.0.shape: has no free place", "domain"},
      {block + "shape = { box = [0.5, 0.5, 3, 2] }\ncut = false\n",
       "8:9: fluid.block.0.shape: overlaps the edge of the domain", "cut = true"},
      {block + "shape = { box = [0, 0, 1, 1] }\n[[fluid.block]]\nshape = { box = [0.2, 0.2, 0.8, 0.8] }\n",
       "10:9: fluid.block.1.shape: has no free place", "an earlier block"},
      {block + "shape = { box = [0, 0, 1, 1] }\n[[fluid.block]]\nshape = { box = [0.5, 0, 1.5, 1] }\ncut = false\n",
       "10:9: fluid.block.1.shape: overlaps an earlier block (50 places)", "cut"},
      {block + "shape = { box = [0, 0, 1, 1] }\n[[body]]\nname = \"all\"\nshape = { box = [0, 0, 2, 1] }\n",
       "8:9: fluid.block.0.shape: has no free place", "body.all"},
      {block + "shape = { box = [0, 0, 1, 1] }\nvelocity = [\"t\", 0]\n", "9:13: fluid.block.0.velocity: ", "x, y"},
      {block + "shape = { box = [0, 0, 1, 1] }\nvelocity = [\"1/(x-x)\", 0]\n",
       "9:12: fluid.block.0.velocity: is [inf, 0]", ""},
      {block + "shape = { box = [0, 0, 1, 1] }\ncount = 5\n", "9:1: fluid.block.0.count: unknown key", "\"cut\""},
  });
}

TEST(SceneRefusal, a_billion_particles_say_the_memory_that_they_would_need) {
  expectRefusals({
      {kHead + "[model]\nspacing = 5e-7\n[[fluid.block]]\nshape = { box = [0, 0, 2, 1] }\n",
       "6:11: model.spacing: 8e+12 particles would need ", "PB"},
      {kHead + "[bullet]\n[[bullet.block]]\ncount = 4000000000\nshape = { box = [0, 0, 2, 1] }\n",
       "7:9: bullet.block.0.count: 4e+09 particles would need ", "GB"},
  });
}

TEST(SceneRefusal, bullets_emitters_and_sinks) {
  const std::string nozzle = kHead + "[[emitter]]\nkind = \"bullet\"\nfrom = [0.5, 0.5]\nto = [0.4, 0.5]\nspeed = 1\n";
  expectRefusals({
      {kHead + "[bullet]\nradius = -1\n", "6:10: bullet.radius: is -1", ""},
      {kHead + "[[bullet.block]]\nshape = { box = [0, 0, 1, 1] }\n", "5:1: bullet.block.0.count: is missing", ""},
      {kHead + "[[bullet.block]]\nshape = { box = [5, 5, 6, 6] }\ncount = 10\n",
       "6:9: bullet.block.0.shape: has no free place", ""},
      {nozzle, "5:1: emitter.0.rate: is missing", ""},
      {nozzle + "rate = 10\nstart = 2\nstop = 1\n", "12:8: emitter.0.stop: is 1", "above 2"},
      {nozzle + "rate = 10\nspread = 200\n", "11:10: emitter.0.spread: is 200", "180"},
      {nozzle + "rate = 10\nlimit = 0\n", "11:9: emitter.0.limit: is 0", "from 1"},
      {nozzle + "rate = 10\npolicy = \"drop\"\n", "11:10: emitter.0.policy: is \"drop\"", "\"refuse\""},
      {kHead + "[[emitter]]\nkind = \"water\"\n", "6:8: emitter.0.kind: is \"water\"", "\"fluid\" or \"bullet\""},
      {kHead + "[[emitter]]\nkind = \"fluid\"\nfrom = [0.5, 0.5]\nto = [0.5, 0.5]\nspeed = 1\n",
       "8:6: emitter.0.to: the nozzle has no length", ""},
      {kHead + "[[emitter]]\nkind = \"fluid\"\nfrom = [0.5, 0.5]\nto = [2.5, 0.5]\nspeed = 1\n",
       "8:6: emitter.0.to: the nozzle's end [2.5, 0.5] is outside the domain", ""},
      {kHead + "[[emitter]]\nkind = \"fluid\"\nfrom = [0.5, 0.5]\nto = [0.4, 0.5]\nspeed = 0\n",
       "9:9: emitter.0.speed: is 0", ""},
      {kHead + "[[emitter]]\nkind = \"fluid\"\nfrom = [0.5, 0.5]\nto = [0.4, 0.5]\nspeed = 1\nrate = 5\n",
       "10:8: emitter.0.rate: belongs to bullets", ""},
      {kHead + "[model]\nspacing = 0.2\n[[emitter]]\nkind = \"fluid\"\nfrom = [0.5, 0.5]\nto = [0.4, 0.5]\nspeed = 1\n",
       "9:8: emitter.0.from: the nozzle is 0.1 m long", "0.2"},
      {kHead + "[[sink]]\n", "5:1: sink.0.shape: is missing", ""},
      {kHead + "[sink]\nshape = 3\n", "5:1: sink: is a table, right are tables, [[sink]]", ""},
  });
}

TEST(SceneRefusal, bodies) {
  const std::string body = kHead + "[[body]]\nname = \"gate\"\nshape = { box = [0, 0, 1, 1] }\n";  // next line is 8
  expectRefusals({
      {body + "denisty = 3\n", "8:1: body.gate.denisty: unknown key", "\"density\""},
      {body + "density = 0\n", "8:11: body.gate.density: is 0", "above 0"},
      {body + "motion = \"moving\"\n", "8:10: body.gate.motion: is \"moving\"", ""},
      {body + "restitution = 1.5\n", "8:15: body.gate.restitution: is 1.5", "at most 1"},
      {body + "origin = \"middle\"\n", "8:10: body.gate.origin: ", "\"centroid\""},
      {body + "slip = \"yes\"\n", "8:8: body.gate.slip: ", "\"free\""},
      {body + "group = -1\n", "8:9: body.gate.group: is -1", ""},
      {body + "spin = 1.0\n", "8:8: body.gate.spin: a fixed body does not move", "scripted"},
      {body + "script = [{ until = 1 }]\n", "8:10: body.gate.script: a fixed body does not move", ""},
      {body + "motion = \"scripted\"\nscript = [{ until = 1 }, { until = 1 }]\n",
       "9:36: body.gate.script.1.until: is 1", "above 1"},
      {body + "motion = \"scripted\"\nscript = [{ velocity = [1, 0] }]\n", "9:11: body.gate.script.0.until: is missing",
       ""},
      {body + "motion = \"scripted\"\nscript = [{ until = 1, spin = \"x\" }]\n", "9:31: body.gate.script.0.spin: \"x\"",
       ""},
      {body + "motion = \"scripted\"\nscript = [{ until = 1, spin = \"1/t\" }]\n",
       "9:31: body.gate.script.0.spin: is not finite", "t = 0"},
      {body + "motion = \"scripted\"\nvelocity = [1, 0]\nscript = [{ until = 1 }]\n",
       "9:12: body.gate.velocity: stands beside a script", ""},
      {body + "position = [5, 5]\n", "8:12: body.gate.position: the body lies wholly outside the domain", ""},
      {body + "[[body]]\nname = \"gate\"\nshape = { box = [0, 0, 1, 1] }\n", "9:8: body.gate.name: \"gate\" is taken",
       ""},
      {kHead + "[[body]]\nname = \"3 gates\"\nshape = { box = [0, 0, 1, 1] }\n",
       "6:8: body.3 gates.name: is \"3 gates\"", "letter"},
      {kHead + "[[body]]\nshape = { polygon = [[0, 0], [1, 1], [1, 0], [0, 1]] }\n",
       "6:21: body.0.shape.polygon: ", "cross"},
      {body + "repeat = { count = [0, 1], step = [[1, 0], [0, 1]] }\n", "8:21: body.gate.repeat.count: ", "from 1"},
      {body + "repeat = { count = [2, 2] }\n", "8:10: body.gate.repeat.step: is missing", ""},
      {body + "repeat = { count = [2, 2], step = [[1, 0]] }\n", "8:35: body.gate.repeat.step: ", "2 of the form"},
      {body + "repeat = { count = [100000, 100000], step = [[1, 0], [0, 1]] }\n",
       "8:20: body.gate.repeat.count: ", "copies"},
      {body + "repeat = { count = [9, 1], step = [[1, 0], [0, 1]] }\n",
       "7:9: body.gate.shape: the body (copy gate.3) lies", ""},
  });
}

TEST(SceneRefusal, free_bodies_and_hinges) {
  const std::string body = kHead + "[[body]]\nname = \"gate\"\nshape = { box = [0, 0, 1, 1] }\n";  // next line is 8
  const std::string free = body + "motion = \"free\"\n";                                           // next line is 9
  expectRefusals({
      {body + "hinge = { at = [0, 0] }\n", "8:9: body.gate.hinge: a hinge holds a free body and this one is fixed",
       "motion = \"free\""},
      {body + "motion = \"scripted\"\nhinge = { at = [0, 0] }\n",
       "9:9: body.gate.hinge: a hinge holds a free body and this one is scripted", "motion = \"free\""},
      {free + "script = [{ until = 1 }]\n", "9:10: body.gate.script: a free body is moved by forces", "\"scripted\""},
      {free + "density = 0\n", "9:11: body.gate.density: is 0", "above 0"},
      {free + "density = -3\n", "9:11: body.gate.density: is -3", "above 0"},
      {free + "density = inf\n", "9:11: body.gate.density: is inf", "above 0"},
      {free + "density = 1e-310\n", "9:11: body.gate.density: gives the free body a mass of 1e-310 kg", ""},
      {free + "velocity = [nan, 0]\n", "9:13: body.gate.velocity", "nan"},
      {free + "hinge = [0, 0]\n", "9:9: body.gate.hinge: ", "table"},
      {free + "hinge = { }\n", "9:9: body.gate.hinge.at: is missing", ""},
      {free + "hinge = { at = [0] }\n", "9:16: body.gate.hinge.at: ", ""},
      {free + "hinge = { at = [0, inf] }\n", "9:20: body.gate.hinge.at", "inf"},
      {free + "hinge = { att = [0, 0] }\n", "9:11: body.gate.hinge.att: unknown key", "\"at\""},
      {free + "hinge = { at = [0, 0], motor = { } }\n", "9:32: body.gate.hinge.motor.speed: is missing", ""},
      {free + "hinge = { at = [0, 0], motor = { speed = 1 } }\n", "9:32: body.gate.hinge.motor.torque: is missing",
       "from 0"},
      {free + "hinge = { at = [0, 0], motor = { speed = 1, torque = -2 } }\n",
       "9:54: body.gate.hinge.motor.torque: is -2", "from 0"},
      {free + "hinge = { at = [0, 0], motor = { speed = nan, torque = 2 } }\n",
       "9:42: body.gate.hinge.motor.speed: is nan", ""},
      {free + "hinge = { at = [0, 0], motor = { speed = 1, torqe = 2 } }\n",
       "9:45: body.gate.hinge.motor.torqe: unknown key", "\"torque\""},
  });
}

TEST(SceneRefusal, gauges) {
  const std::string scene =
      kHead + kFluid + "[[body]]\nname = \"gate\"\nshape = { box = [1.5, 0, 1.6, 1] }\n";  // 15 lines
  const std::string gauge = scene + "[[gauge]]\nname = \"g\"\n";                           // next is 18
  expectRefusals({
      {scene + "[[gauge]]\ntype = \"toe\"\n", "16:1: gauge.0.name: is missing", ""},
      {scene + "[[gauge]]\nname = \"a.b\"\n", "17:8: gauge.a.b.name: is \"a.b\"", "letter"},
      {scene + "[[gauge]]\nname = \"t\"\n", "17:8: gauge.t.name: ", "time"},
      {gauge + "type = \"toe\"\n[[gauge]]\nname = \"g\"\ntype = \"toe\"\n", "20:8: gauge.g.name: \"g\" is taken", ""},
      {gauge, "16:1: gauge.g.type: is missing", ""},
      {gauge + "type = \"tow\"\n", "18:8: gauge.g.type: \"tow\" is no type of gauge", "\"toe\""},
      {gauge + "type = \"tip\"\nsoft = \"jelly\"\n", "19:8: gauge.g.soft: \"jelly\" names no soft body", "none"},
      {gauge + "type = \"area\"\n", "16:1: gauge.g.soft: is missing", ""},
      {gauge + "type = \"toe\"\nx = 0.5\n", "19:1: gauge.g.x: a gauge of type toe takes no parameter", ""},
      {gauge + "type = \"height\"\n", "16:1: gauge.g.x: is missing", ""},
      {gauge + "type = \"height\"\nx = 2.5\n", "19:5: gauge.g.x: is 2.5", "at most 2"},
      {gauge + "type = \"height\"\nx = 0.5\nat = [0, 0]\n", "20:1: gauge.g.at: a gauge of type height takes only x",
       ""},
      {gauge + "type = \"pressure\"\nat = [0.5, 3]\n", "19:6: gauge.g.at: the point [0.5, 3] is outside", ""},
      {gauge + "type = \"front\"\naxis = \"z\"\n", "19:8: gauge.g.axis: is \"z\"", ""},
      {gauge + "type = \"front\"\nquantile = 2\n", "19:12: gauge.g.quantile: is 2", ""},
      {gauge + "type = \"profile\"\nfrom = [0, 0]\nto = [1, 0]\ncount = 1\n", "21:9: gauge.g.count: is 1", "from 2"},
      {gauge + "type = \"force\"\nbody = \"gat\"\n", "19:8: gauge.g.body: \"gat\" names no body", "\"gate\""},
      {gauge + "type = \"energy\"\nspecies = \"bullet\"\n", "19:11: gauge.g.species: ", "no such particles"},
      {gauge + "type = \"toe\"\nevery = 0\n", "19:9: gauge.g.every: is 0", "above 0"},
      {gauge + "type = \"toe\"\nevery = 1e-12\n", "19:9: gauge.g.every: asks for 1e+12 rows", ""},
      {kHead + "[[gauge]]\nname = \"g\"\ntype = \"toe\"\n", "7:8: gauge.g.type: \"toe\" reads the fluid", "none"},
      {kHead + "[[gauge]]\nname = \"g\"\ntype = \"pose\"\nbody = \"b\"\n", "8:8: gauge.g.body: ", "the scene has none"},
  });
}

TEST(SceneRefusal, output) {
  expectRefusals({
      {kHead + "[output]\nevery = 0\n", "6:9: output.every: is 0", ""},
      {kHead + "[output]\nevery = 1e-9\n", "6:9: output.every: asks for 1e+09 frames", ""},
      {kHead + "[output]\nframes = [\"vbd\"]\n", "6:11: output.frames: ", "\"vdb\""},
      {kHead + "[output]\nframes = \"png\"\n", "6:10: output.frames: is a string", "list"},
      {kHead + "[output]\ncheckpoint = 0\n", "6:14: output.checkpoint: is 0", ""},
      {kHead + "[output]\npng = { width = 3 }\n", "6:17: output.png.width: is 3", "from 16"},
      {kHead + "[output]\npng = { range = [1, 0] }\n", "6:17: output.png.range: ", "min < max"},
      {kHead + "[output]\npng = { colour = \"speed\" }\n", "6:9: output.png.colour: unknown key", "\"color\""},
      {kHead + "[output]\npng = { color = \"red\" }\n", "6:17: output.png.color: is \"red\"", "\"pressure\""},
      {kHead + "[output]\npng = { view = [0, 0, 0, 1] }\n", "6:16: output.png.view: ", "xmin < xmax"},
  });
}

TEST(SceneRefusal, no_file_of_rubbish_does_worse_than_a_refusal) {
  const std::string whole =
      kHead + kFluid +
      "[[body]]\nname = \"gate\"\nshape = { polygon = [[1.5, 0.0], [1.6, 0.0], [1.6, 0.5]], holes = [] }\n"
      "motion = \"scripted\"\nscript = [{ until = 1.0, velocity = [\"sin(t)\", 0.0] }]\n"
      "repeat = { count = [2, 1], step = [[0.2, 0.0], [0.0, 0.0]], turn = 1.0 }\n"
      "[[gauge]]\nname = \"toe\"\ntype = \"toe\"\nevery = 0.1\n[output]\nframes = [\"png\"]\n";
  ASSERT_EQ(refusal(whole), "accepted");
  const std::string bytes = "\n[]{}=\"'.,#-0e9ax_\\ \t\xC3\xFF";
  std::uint64_t state = 1;
  const auto next = [&state](std::size_t bound) {
    state = state * 6364136223846793005ull + 1442695040888963407ull;
    return static_cast<std::size_t>((state >> 33) % bound);
  };
  int refused = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::string text = whole;
    for (std::size_t change = 0; change <= next(3); ++change) {
      const std::size_t at = next(text.size());
      switch (next(4)) {
        case 0:
          text.erase(at, 1 + next(8));
          break;
        case 1:
          text[at] = bytes[next(bytes.size())];
          break;
        case 2:
          text.insert(at, 1, bytes[next(bytes.size())]);
          break;
        default:
          text.insert(at, text.substr(next(text.size()), next(20)));
      }
    }
    const std::string got = refusal(text);  // anything but a SceneError or a scene fails the test
    refused += got != "accepted";
    EXPECT_EQ(got.rfind("the message", 0), std::string::npos) << got;
  }
  EXPECT_GT(refused, 200);
}

}  // namespace
}  // namespace froude
