// How a run tells that it is alive: a bar on a terminal, a line every few seconds in a log.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace froude::run {

/// All on stderr. Construction decides by the kind of stderr; `quiet` says nothing at all.
class Progress {
 public:
  /// From simulated time `begin` to `end` [s].
  Progress(double begin, double end, bool quiet);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Cheap enough for every step: it looks at the clock and mostly does nothing.
  void update(double time, std::size_t particles);
  /// A line of its own, not torn by the bar. Said even when quiet, unless the caller is.
  void say(const std::string& line);
  /// Takes the bar away.
  void finish();

 private:
  using Clock = std::chrono::steady_clock;
  std::string describe(double time, std::size_t particles, Clock::time_point now) const;

  double begin_, end_;
  bool quiet_, terminal_;
  bool shown_ = false;
  Clock::time_point start_, last_;
};

/// Lines at the bottom of a terminal, drawn over themselves; nothing where stderr is none.
class LiveLines {
 public:
  LiveLines();
  ~LiveLines() { clear(); }
  LiveLines(const LiveLines&) = delete;
  LiveLines& operator=(const LiveLines&) = delete;

  bool onTerminal() const { return terminal_; }
  /// Cut to the terminal's width, and to its height.
  void draw(const std::vector<std::string>& lines);
  /// A line that stays, above the others; also where there is no terminal.
  void say(const std::string& line);
  void clear();

 private:
  bool terminal_;
  std::size_t shown_ = 0;
};

/// "[======          ]" of `width` characters between the brackets, for a part between 0 and 1.
std::string bar(double part, int width);

/// Is stderr a terminal on which colour is welcome (NO_COLOR is not set, TERM is not "dumb")?
bool colourWelcome();
/// "error: " or "warning: " as it should look on stderr.
std::string label(const std::string& word);
/// "1 h 02 min", "3 min 20 s", "4.5 s".
std::string durationInWords(double seconds);

}  // namespace froude::run
