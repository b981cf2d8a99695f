// How a run tells that it is alive: a bar on a terminal, a line every few seconds in a log.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>

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

/// Is stderr a terminal on which colour is welcome (NO_COLOR is not set, TERM is not "dumb")?
bool colourWelcome();
/// "error: " or "warning: " as it should look on stderr.
std::string label(const std::string& word);
/// "1 h 02 min", "3 min 20 s", "4.5 s".
std::string durationInWords(double seconds);

}  // namespace froude::run
