#include "cli/field.h"

#include <fmt/format.h>
#include <froude/fields/distance_field.h>

#include <cstdio>
#include <iterator>

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

int checkField() { throw run::UsageError("--check: not in this version: this build has no OpenVDB to compare with"); }

int drawPicture(const FieldRequest& request, const scene::ShapeArgument& shape) {
  for (const std::string& remark : exporting::drawField(request.output, shape.polygon, shape.name, request.picture))
    fmt::print(stderr, "{}: note: {}\n", request.shape, remark);
  fmt::print("{}\n", request.output);
  return run::kDone;
}

}  // namespace

int fieldCommand(const FieldRequest& request) {
  if (request.check) return checkField();
  run::letWritesFail();
  const scene::ShapeArgument shape = scene::readShapeArgument(request.shape, request.svg);
  for (const std::string& note : shape.notes) fmt::print(stderr, "{}: note: {}\n", request.shape, note);
  return request.points.empty() ? drawPicture(request, shape) : answerPoints(request, shape.polygon);
}

}  // namespace froude::cli
