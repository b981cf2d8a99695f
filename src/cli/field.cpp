#include "cli/field.h"

#include <fmt/format.h>
#include <froude/fields/distance_field.h>

#include <cstdio>
#include <iostream>
#include <iterator>

#include "cli/field_check.h"
#include "run/atomic_file.h"
#include "run/exit_codes.h"
#include "run/signals.h"
#include "scene/point_table.h"

namespace froude::cli {
namespace {

constexpr double kFarthest = 1e100;  // squares of coordinates stay finite [m]
constexpr double kShare = 0.1;  // band against the shape's size: points near the boundary, which are most, are quick

/// −0 is a number that nobody wants to read.
double plain(double value) { return value + 0.0; }

std::string answers(const Polygon& polygon, const std::vector<Vec2>& points) {
  const DistanceField field(polygon, kShare * polygon.bounds().size().maxCoeff());
  std::string text = "x,y,distance,normal_x,normal_y,closest_x,closest_y\n";
  for (const Vec2& p : points) {
    const FieldSample s = field.sampleExact(p);
    fmt::format_to(std::back_inserter(text), "{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g},{:.17g}\n", p.x(), p.y(),
                   plain(s.distance), plain(s.normal.x()), plain(s.normal.y()), plain(s.closest.x()),
                   plain(s.closest.y()));
  }
  return text;
}

int answerPoints(const FieldRequest& request, const Polygon& polygon) {
  const std::string text = answers(polygon, scene::readPoints(request.points, kFarthest));
  if (request.output.empty()) {
    std::fwrite(text.data(), 1, text.size(), stdout);
  } else {
    run::writeWholeFile(request.output, text);
    fmt::print("{}\n", request.output);
  }
  return run::kDone;
}

int drawPicture(const FieldRequest& request, const scene::ShapeArgument& shape) {
  for (const std::string& remark : exporting::drawField(request.output, shape.polygon, shape.name, request.picture))
    fmt::print(stderr, "{}: note: {}\n", request.shape, remark);
  fmt::print("{}\n", request.output);
  return run::kDone;
}

}  // namespace

int fieldCommand(const FieldRequest& request) {
  run::letWritesFail();
  const scene::ShapeArgument shape = scene::readShapeArgument(request.shape, request.svg);
  for (const std::string& note : shape.notes) fmt::print(stderr, "{}: note: {}\n", request.shape, note);
  if (request.check) return printFieldCheck(shape.polygon, shape.name, std::cout);
  return request.points.empty() ? drawPicture(request, shape) : answerPoints(request, shape.polygon);
}

}  // namespace froude::cli
