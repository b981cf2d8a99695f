#include "run/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace froude::run {
namespace {

constexpr std::chrono::milliseconds kBarInterval{100};
constexpr std::chrono::seconds kLogInterval{5};
constexpr int kBarWidth = 30;  // [characters]

int terminalWidth() {
  winsize size{};
  return ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 ? size.ws_col : 80;
}

}  // namespace

bool colourWelcome() {
  const char* noColour = std::getenv("NO_COLOR");
  const char* terminal = std::getenv("TERM");
  if (noColour != nullptr && *noColour != '\0') return false;  // https://no-color.org
  return isatty(STDERR_FILENO) == 1 && (terminal == nullptr || std::string_view(terminal) != "dumb");
}

std::string label(const std::string& word) {
  if (!colourWelcome()) return word + ": ";
  return (word == "error" ? "\033[1;31m" : "\033[1;33m") + word + ":\033[0m ";
}

std::string durationInWords(double seconds) {
  if (!(seconds < 1e9)) return "unknown";
  if (seconds < 60.0) return fmt::format("{:.1f} s", seconds);
  const long whole = std::lround(seconds);
  if (whole < 3600) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} h {:02} min", whole / 3600, whole % 3600 / 60);
}

Progress::Progress(double begin, double end, bool quiet)
    : begin_(begin),
      end_(end),
      quiet_(quiet),
      terminal_(isatty(STDERR_FILENO) == 1),
      start_(Clock::now()),
      last_(start_) {}

Progress::~Progress() { finish(); }

void Progress::update(double time, std::size_t particles) {
  if (quiet_) return;
  const Clock::time_point now = Clock::now();
  if (now - last_ < (terminal_ ? Clock::duration(kBarInterval) : Clock::duration(kLogInterval))) return;
  last_ = now;
  const std::string text = describe(time, particles, now);
  if (!terminal_) {
    fmt::print(stderr, "{}\n", text);
    return;
  }
  const double done = std::clamp((time - begin_) / (end_ - begin_), 0.0, 1.0);
  const int filled = static_cast<int>(done * kBarWidth);
  std::string bar = fmt::format("[{:=<{}}{: <{}}] {}", "", filled, "", kBarWidth - filled, text);
  bar.resize(std::min(bar.size(), static_cast<std::size_t>(terminalWidth() - 1)));
  fmt::print(stderr, "\r\033[K{}", bar);
  std::fflush(stderr);
  shown_ = true;
}

std::string Progress::describe(double time, std::size_t particles, Clock::time_point now) const {
  const double wall = std::chrono::duration<double>(now - start_).count();
  const double rate = (time - begin_) / wall;
  const std::string live = particles > 0 ? fmt::format(" {} particles,", particles) : "";  // none: a world of bodies
  return fmt::format("{:.4g} of {:.4g} s,{} {:.3g} simulated s per s, {} left", time, end_, live, rate,
                     durationInWords((end_ - time) / rate));
}

void Progress::say(const std::string& line) {
  finish();
  fmt::print(stderr, "{}\n", line);
}

void Progress::finish() {
  if (shown_) fmt::print(stderr, "\r\033[K");
  shown_ = false;
}

}  // namespace froude::run
