#include "export/film.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "export/frames.h"
#include "run/atomic_file.h"
#include "run/machine.h"
#include "run/process.h"

namespace froude::exporting {
namespace {

constexpr double kSlowest = 10.0, kFastest = 60.0;  // pictures a second

std::string lastLine(const std::string& text) {
  const std::size_t end = text.find_last_not_of("\r\n");
  if (end == std::string::npos) return "it said nothing";
  const std::size_t begin = text.find_last_of('\n', end);
  return text.substr(begin == std::string::npos ? 0 : begin + 1,
                     end - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

}  // namespace

Film makeFilm(const std::string& folder, double every) {
  const std::string ffmpeg = run::findProgram("ffmpeg");
  if (ffmpeg.empty()) return {"", "no film: ffmpeg is not installed"};
  std::error_code ignored;
  if (!std::filesystem::exists(folder + "/frame_00000.png", ignored)) return {"", "no film: there are no pictures"};

  run::PendingFile pending(folder + "/film.mp4");
  const std::string part = std::filesystem::path(pending.path()).filename().string();
  const std::string rate = fmt::format("{:g}", std::clamp(1.0 / every, kSlowest, kFastest));
  // Names are relative and ffmpeg runs in the folder: a % in the folder's own path would count as a pattern.
  try {
    const run::ProcessResult result = run::runProcess({ffmpeg,
                                                       "-nostdin",
                                                       "-loglevel",
                                                       "error",
                                                       "-y",
                                                       "-framerate",
                                                       rate,
                                                       "-start_number",
                                                       "0",
                                                       "-i",
                                                       "frame_%05d.png",
                                                       "-vf",
                                                       "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white",
                                                       "-c:v",
                                                       "libx264",
                                                       "-preset",
                                                       "medium",
                                                       "-crf",
                                                       "18",
                                                       "-pix_fmt",
                                                       "yuv420p",
                                                       "-movflags",
                                                       "+faststart",
                                                       "-f",
                                                       "mp4",
                                                       part},
                                                      folder);
    if (!result.ok()) return {"", "no film: ffmpeg failed: " + lastLine(result.errors)};
    pending.commit();
  } catch (const Error& e) {
    return {"", std::string("no film: ") + e.what()};
  }
  return {folder + "/film.mp4", ""};
}

}  // namespace froude::exporting
