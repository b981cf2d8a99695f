// A film of a run's pictures, by ffmpeg where it is installed.
#pragma once

#include <string>

namespace froude::exporting {

struct Film {
  std::string file;  // film.mp4 with its folder, or empty:
  std::string note;  // … then why there is none
};

/// Joins frame_00000.png … in `folder` to film.mp4 (H.264, yuv420p, even sizes), one picture for `every` seconds of the
/// scene where that makes 10 to 60 pictures a second. Written beside and renamed. A film is an extra: what goes wrong
/// becomes a note and leaves nothing behind.
Film makeFilm(const std::string& folder, double every);

}  // namespace froude::exporting
