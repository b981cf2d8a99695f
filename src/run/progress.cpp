#include "run/progress.h"

#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string_view>
#include <utility>

namespace froude::run {
namespace {

constexpr std::chrono::milliseconds kBarInterval{100};
constexpr std::chrono::seconds kLogInterval{5};
constexpr int kBarWidth = 30;  // [characters]

// Columns and rows.
std::pair<int, int> terminalSize() {
  winsize size{};
  if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return {80, 24};
  return {size.ws_col, size.ws_row > 0 ? size.ws_row : 24};
}

// Bytes of the first `columns` characters.
std::string cut(const std::string& text, int columns) {
  std::size_t end = 0;
  for (int seen = 0; end < text.size(); ++end) {
    const bool starts = (static_cast<unsigned char>(text[end]) & 0xC0) != 0x80;
    if (starts && ++seen > columns) break;
  }
  return text.substr(0, end);
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
  const std::string line = bar((time - begin_) / (end_ - begin_), kBarWidth) + " " + text;
  fmt::print(stderr, "\r\033[K{}", cut(line, terminalSize().first - 1));
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

std::string bar(double part, int width) {
  const int filled = static_cast<int>(std::clamp(part, 0.0, 1.0) * width);  // NaN, of an empty span, is full
  return fmt::format("[{:=<{}}{: <{}}]", "", filled, "", width - filled);
}

LiveLines::LiveLines() : terminal_(isatty(STDERR_FILENO) == 1) {}

void LiveLines::clear() {
  for (; shown_ > 0; --shown_) fmt::print(stderr, "\033[A\r\033[K");
  std::fflush(stderr);
}

void LiveLines::draw(const std::vector<std::string>& lines) {
  if (!terminal_) return;
  const auto [columns, rows] = terminalSize();
  std::string text;
  for (std::size_t k = 0; k < shown_; ++k) text += "\033[A\r\033[K";
  shown_ = std::min(lines.size(), static_cast<std::size_t>(std::max(rows - 1, 1)));
  for (std::size_t k = lines.size() - shown_; k < lines.size(); ++k) text += cut(lines[k], columns - 1) + "\n";
  fmt::print(stderr, "{}", text);
  std::fflush(stderr);
}

void LiveLines::say(const std::string& line) {
  clear();
  fmt::print(stderr, "{}\n", line);
}

}  // namespace froude::run
