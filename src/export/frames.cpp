#include "export/frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "export/film.h"
#include "export/png_painter.h"
#include "export/segments.h"
#include "export/vdb_frames.h"

namespace froude::exporting {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLargestSegment = 256 << 20;  // [bytes]

/// The number in "PREFIX00012SUFFIX"; −1 for any other name.
int numberIn(std::string_view name, std::string_view prefix, std::string_view suffix) {
  if (!name.starts_with(prefix) || !name.ends_with(suffix) || name.size() <= prefix.size() + suffix.size()) return -1;
  const std::string_view digits = name.substr(prefix.size(), name.size() - prefix.size() - suffix.size());
  int number = -1;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
  return error == std::errc() && end == digits.data() + digits.size() ? number : -1;
}

/// Numbers of all files of a folder with such names, rising.
std::vector<int> numbersIn(const std::string& folder, std::string_view prefix, std::string_view suffix) {
  std::vector<int> numbers;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end; it.increment(error)) {
    const int number = numberIn(it->path().filename().string(), prefix, suffix);
    if (number >= 0) numbers.push_back(number);
  }
  std::sort(numbers.begin(), numbers.end());
  return numbers;
}

void removeFile(const std::string& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error) throw OutputError(file + ": cannot be removed: " + error.message());
}

}  // namespace

struct FrameWriter::Impl {
  std::string folder;
  bool png, h5, vdb;
  double every;  // [s]
  PngPainter painter;
  std::optional<VdbFrames> grids;
  std::vector<FrameEntry> closed;
  std::optional<Segment> open;
  int nextSegment = 0;
  std::string filmNote;

  Impl(std::string where, const scene::Scene& scene)
      : folder(std::move(where)),
        png(scene.output.png),
        h5(scene.output.h5),
        vdb(scene.output.vdb),
        every(scene.output.every),
        painter(scene) {}

  std::string fileOf(int index, const std::string& ending) const { return folder + "/" + frameName(index) + ending; }

  void makeSegmentFolder() const {
    std::error_code error;
    fs::create_directories(folder + "/frames", error);
    if (error) throw OutputError(folder + "/frames: cannot be made: " + error.message());
  }

  /// Drops pictures, grids and frames from `next` on, and segments left half-written by a crash.
  void dropFrom(int next) {
    for (const char* ending : {".png", ".vdb"})
      for (const int k : numbersIn(folder, "frame_", ending))
        if (k >= next) removeFile(fileOf(k, ending));
    const std::string part(".h5.part");
    for (const int k : numbersIn(folder + "/frames", "", part)) removeFile(folder + "/" + segmentFile(k) + ".part");
    for (const int k : numbersIn(folder + "/frames", "", ".h5")) {
      const std::string file = folder + "/" + segmentFile(k);
      const std::vector<FrameEntry> all = readSegment(folder, k);
      std::vector<FrameEntry> kept;
      std::copy_if(all.begin(), all.end(), std::back_inserter(kept),
                   [&](const FrameEntry& f) { return f.index < next; });
      if (kept.empty()) {
        removeFile(file);
        continue;
      }
      if (kept.size() < all.size()) {
        Segment shorter(k);
        for (const FrameEntry& f : kept) shorter.copy(file, f);
        shorter.save(folder);
      }
      closed.insert(closed.end(), kept.begin(), kept.end());
      nextSegment = k + 1;
    }
    if (h5) {
      makeSegmentFolder();
      writeIndex(folder, closed);
    }
  }
};

FrameWriter::FrameWriter(std::string folder, const scene::Scene& scene, const World& world, int nextFrame)
    : impl_(std::make_unique<Impl>(std::move(folder), scene)) {
  if (impl_->vdb) impl_->grids.emplace(world);
  if (nextFrame > 0)
    impl_->dropFrom(nextFrame);
  else if (impl_->h5)
    impl_->makeSegmentFolder();
}

FrameWriter::~FrameWriter() = default;

void FrameWriter::write(const World& world, int index) {
  if (impl_->png) impl_->painter.draw(impl_->fileOf(index, ".png"), world);
  if (impl_->grids) impl_->grids->write(impl_->fileOf(index, ".vdb"), world, index);
  if (!impl_->h5) return;
  if (!impl_->open) impl_->open.emplace(impl_->nextSegment);
  impl_->open->add(world, index);
  if (impl_->open->bytes() > kLargestSegment) closeSegment();
}

void FrameWriter::closeSegment() {
  Impl& d = *impl_;
  if (!d.open) return;
  d.open->save(d.folder);
  std::vector<FrameEntry> all = d.closed;
  all.insert(all.end(), d.open->frames().begin(), d.open->frames().end());
  writeIndex(d.folder, all);
  d.closed = std::move(all);
  d.open.reset();
  ++d.nextSegment;
}

std::string FrameWriter::makeFilm() {
  Film film = exporting::makeFilm(impl_->folder, impl_->every);
  impl_->filmNote = std::move(film.note);
  return film.file;
}

const std::string& FrameWriter::filmNote() const { return impl_->filmNote; }

}  // namespace froude::exporting
