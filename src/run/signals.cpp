#include "run/signals.h"

#include <signal.h>
#include <unistd.h>

#include <array>
#include <atomic>

namespace froude::run {
namespace {

std::atomic<int> caughtSignal{0};  // the handler may run in any thread
static_assert(std::atomic<int>::is_always_lock_free);
std::array<struct sigaction, 4> previousActions;
constexpr std::array<int, 4> kSignals{SIGINT, SIGTERM, SIGPIPE, SIGXFSZ};

extern "C" void onSignal(int signal) {
  if (caughtSignal.exchange(signal) != 0) _exit(128 + signal);
}

}  // namespace

void letWritesFail() {
  for (const int signal : {SIGPIPE, SIGXFSZ}) {
    struct sigaction action {};
    action.sa_handler = SIG_IGN;
    sigemptyset(&action.sa_mask);
    sigaction(signal, &action, nullptr);
  }
}

SignalGuard::SignalGuard() {
  caughtSignal = 0;
  for (std::size_t i = 0; i < kSignals.size(); ++i) {
    struct sigaction action {};
    action.sa_handler = kSignals[i] == SIGINT || kSignals[i] == SIGTERM ? onSignal : SIG_IGN;
    action.sa_flags = SA_RESTART;
    sigemptyset(&action.sa_mask);
    sigaction(kSignals[i], &action, &previousActions[i]);
  }
}

SignalGuard::~SignalGuard() {
  for (std::size_t i = 0; i < kSignals.size(); ++i) sigaction(kSignals[i], &previousActions[i], nullptr);
}

int SignalGuard::pending() const { return caughtSignal; }

}  // namespace froude::run
