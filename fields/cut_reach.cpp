#include <froude/fields/cut_reach.h>

#include <froude/fields/cut_pieces.h>

namespace froude {
namespace {

std::int32_t wrapped(std::int32_t i, std::int32_t period) {
  if (period <= 0) return i;
  return i < 0 ? i + period : i >= period ? i - period : i;
}

CutSide opposite(CutSide side) { return static_cast<CutSide>(static_cast<std::uint8_t>(side) ^ 1u); }

}  // namespace

void CutReach::build(const CutGrid& grid, const CutCells& cut) {
  grid_ = grid;
  cut_ = &cut;
  stencils_.clear();
  near_.clear();
  for (const CutCell& cell : cut.cells()) {
    if (cell.partCount < 2) continue;
    for (std::int32_t dj = -1; dj <= 1; ++dj) {
      for (std::int32_t di = -1; di <= 1; ++di) {
        const std::int32_t i = wrapped(cell.i + di, grid.periodX), j = wrapped(cell.j + dj, grid.periodY);
        if (cut.find(i, j) < 0 && !cut.solid(i, j)) near_.push_back(detail::cutKey(i, j));
      }
    }
  }
  std::sort(near_.begin(), near_.end());
  near_.erase(std::unique(near_.begin(), near_.end()), near_.end());
  std::size_t next = 0;
  auto considerNear = [&](std::uint64_t end) {
    for (; next < near_.size() && near_[next] < end; ++next) {
      consider({detail::cutColumn(near_[next]), detail::cutRow(near_[next]), -1, -1});
    }
  };
  for (std::size_t c = 0; c < cut.cells().size(); ++c) {
    const CutCell& cell = cut.cells()[c];
    considerNear(detail::cutKey(cell.i, cell.j));
    for (std::uint32_t p = 0; p < cell.partCount; ++p) {
      consider({cell.i, cell.j, static_cast<std::int32_t>(c), static_cast<std::int32_t>(cell.part + p)});
    }
  }
  considerNear(~std::uint64_t{0});
}

std::size_t CutReach::begin(std::int32_t i, std::int32_t j) const {
  const std::uint64_t key = detail::cutKey(i, j);
  return static_cast<std::size_t>(
      std::lower_bound(stencils_.begin(), stencils_.end(), key,
                       [](const CutStencil& s, std::uint64_t k) { return detail::cutKey(s.i, s.j) < k; }) -
      stencils_.begin());
}

CutReach::Place CutReach::neighbour(const Place& at, CutSide side) const {
  const std::int32_t di = side == CutSide::Left ? -1 : side == CutSide::Right ? 1 : 0;
  const std::int32_t dj = side == CutSide::Bottom ? -1 : side == CutSide::Top ? 1 : 0;
  const std::int32_t i = wrapped(at.i + di, grid_.periodX), j = wrapped(at.j + dj, grid_.periodY);
  return {i, j, cut_->find(i, j), -1};
}

// Through the widest joint on that side.
CutReach::Step CutReach::step(const Place& at, CutSide side) const {
  Step step;
  step.beyond = neighbour(at, side);
  if (at.part < 0 && step.beyond.cell < 0) {  // both wholly open: no outline passes between them
    step.open = true;
    step.face = CutStencil::kMain;
    return step;
  }
  double widest = 0.0;
  // A cell that is not listed has no joints of its own: those of the cell beyond are looked through.
  const bool own = at.part >= 0;
  const CutCell* other = own ? nullptr : &cut_->cells()[static_cast<std::size_t>(step.beyond.cell)];
  const std::uint32_t first = own ? static_cast<std::uint32_t>(at.part) : other->part;
  const std::uint32_t count = own ? 1 : other->partCount;
  for (std::uint32_t p = first; p < first + count; ++p) {
    const CutPart& part = cut_->parts()[p];
    for (const CutJoint& joint : cut_->joints().subspan(part.joint, part.jointCount)) {
      if (joint.side != (own ? side : opposite(side)) || joint.length <= widest) continue;
      widest = joint.length;
      step.open = true;
      step.face = joint.edge + 1;
      step.beyond.part = own ? joint.part : static_cast<std::int32_t>(p);
    }
  }
  return step;
}

// The face on the side `second` of what lies beyond `first`.
std::int32_t CutReach::faceBeyond(const Place& at, CutSide first, CutSide second) const {
  const Step to = step(at, first);
  return to.open ? step(to.beyond, second).face : CutStencil::kHidden;
}

bool CutReach::mainOpen(std::int32_t i, std::int32_t j, bool vertical) const {
  const Place at{wrapped(i, grid_.periodX), wrapped(j, grid_.periodY), -1, -1};
  const std::int32_t cell = cut_->find(at.i, at.j);
  const auto side = static_cast<std::size_t>(vertical ? CutSide::Left : CutSide::Bottom);
  if (cell >= 0) return cut_->cells()[static_cast<std::size_t>(cell)].open[side] > 0.0;
  const Place before = neighbour(at, vertical ? CutSide::Left : CutSide::Bottom);
  if (before.cell >= 0) return cut_->cells()[static_cast<std::size_t>(before.cell)].open[side ^ 1u] > 0.0;
  return !cut_->solid(at.i, at.j);
}

void CutReach::consider(const Place& at) {
  constexpr CutSide kLeft = CutSide::Left, kRight = CutSide::Right, kBottom = CutSide::Bottom, kTop = CutSide::Top;
  CutStencil stencil;
  stencil.i = at.i;
  stencil.j = at.j;
  stencil.part = at.part;
  // By way of the cell above or below (left or right); if that is closed, round by the other.
  auto corner = [&](CutSide first, CutSide second) {
    const std::int32_t face = faceBeyond(at, first, second);
    if (face >= 0) return face;
    const Step to = step(at, second);
    const Step on = to.open ? step(to.beyond, first) : Step();
    return on.open ? step(on.beyond, opposite(second)).face : CutStencil::kHidden;
  };
  stencil.face = {corner(kBottom, kLeft),  corner(kBottom, kRight), step(at, kLeft).face,   step(at, kRight).face,
                  corner(kTop, kLeft),     corner(kTop, kRight),    corner(kLeft, kBottom), step(at, kBottom).face,
                  corner(kRight, kBottom), corner(kLeft, kTop),     step(at, kTop).face,    corner(kRight, kTop)};
  const bool main =
      at.part < 0 || static_cast<std::uint32_t>(at.part) == cut_->cells()[static_cast<std::size_t>(at.cell)].part;
  bool usual = main;
  for (std::int32_t k = 0; k < 12 && usual; ++k) {
    const std::int32_t face = stencil.face[static_cast<std::size_t>(k)];
    const bool vertical = k < 6;
    const std::int32_t i = at.i + (vertical ? k % 2 : (k - 6) % 3 - 1), j = at.j + (vertical ? k / 2 - 1 : (k - 6) / 3);
    usual = face == CutStencil::kMain || (face == CutStencil::kHidden && !mainOpen(i, j, vertical));
  }
  if (!usual) stencils_.push_back(stencil);
}

}  // namespace froude
