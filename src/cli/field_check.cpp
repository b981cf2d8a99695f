#include "cli/field_check.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <ostream>

#include "run/exit_codes.h"
#include "run/progress.h"

#if FROUDE_HAS_OPENVDB
#include <froude/fields/openvdb/cross_check.h>
#include <froude/fields/openvdb/level_set.h>

#include "run/machine.h"
#endif

namespace froude::cli {

#if FROUDE_HAS_OPENVDB

namespace {

using vdb::CrossCheck;
using vdb::CrossCheckRow;

/// A number, or a dash where no point stood behind it.
std::string shown(double value, std::size_t count) { return count > 0 ? fmt::format("{:.1e}", value) : "-"; }

void printRows(const CrossCheck& check, std::ostream& out) {
  fmt::print(out, "{:>11} {:>8} {:>7} {:>7} {:>6} {:>7} | {:>7} {:>8} {:>8} {:>10} {:>10} | {:>9} {:>8}\n", "voxel [m]",
             "points", "max", "rms", "wrong", "deepest", "clear", "max", "rms", "normal max", "normal rms", "active",
             "memory");
  for (const CrossCheckRow& row : check.rows) {
    const std::size_t n = row.clearDistance.count;
    fmt::print(
        out, "{:>11.5g} {:>8} {:>7.3f} {:>7.4f} {:>6} {:>7.3f} | {:>7} {:>8} {:>8} {:>10} {:>10} | {:>9} {:>8}\n",
        row.voxelSize, row.distance.count, row.distance.max, row.distance.rms, row.wrongSides, row.deepestWrong, n,
        shown(row.clearDistance.max, n), shown(row.clearDistance.rms, n), shown(row.clearNormal.max, n),
        shown(row.clearNormal.rms, n), row.activeVoxels, run::bytesInWords(static_cast<double>(row.memoryBytes)));
  }
}

void printVerdict(const CrossCheck& check, std::ostream& out) {
  fmt::print(out, "slope of the error over the voxel: max {:.2f}, rms {:.2f} (1: in proportion)\n", check.slopeMax,
             check.slopeRms);
  std::size_t clear = 0;
  for (const CrossCheckRow& row : check.rows) clear += row.clearDistance.count;
  if (clear == 0)
    fmt::print(out,
               "no point is clear of corners by two of these voxels: finer ones would be needed to compare edges\n");
  else if (check.clearAgrees())
    fmt::print(out, "away from corners the two agree to single precision\n");
  else
    fmt::print(out, "away from corners the two DIFFER by more than single precision explains ({:.1e} voxels)\n",
               check.rows.back().rounding);
  if (check.worst() > vdb::kLipschitzBound + check.rows.back().rounding)
    fmt::print(
        out,
        "errors above {:.3f} voxels: nodes on the wrong side; the shape has parts thinner than about two voxels, "
        "which OpenVDB loses\n",
        vdb::kLipschitzBound);
}

}  // namespace

int printFieldCheck(const Polygon& polygon, const std::string& name, std::ostream& out) {
  const Vec2 size = polygon.bounds().size();
  fmt::print(out, "{}: {} edges, {:.6g} m x {:.6g} m, against OpenVDB {}\n", name, polygon.edgeCount(), size.x(),
             size.y(), vdb::version());
  fmt::print(out,
             "distances in voxels, angles in radians; clear: the same edge is closest within two voxels; wrong: points "
             "whose sides differ, and the deepest\n\n");
  const CrossCheck check = vdb::crossCheck(polygon);
  printRows(check, out);
  fmt::print(out, "\n");
  printVerdict(check, out);
  return run::kDone;
}

#else

int printFieldCheck(const Polygon&, const std::string& name, std::ostream&) {
  fmt::print(stderr,
             "{}{}: this build of Froude has no OpenVDB to compare with; build it with -DFROUDE_OPENVDB=ON (Debian: "
             "libopenvdb-dev libboost-iostreams-dev)\n",
             run::label("error"), name);
  return run::kUsageError;
}

#endif

}  // namespace froude::cli
