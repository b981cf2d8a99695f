// Loaded before a program, it makes every clock jump by hours, back and forth, at every look.
#include <dlfcn.h>
#include <time.h>

extern "C" int clock_gettime(clockid_t clock, struct timespec* time) {
  using Real = int (*)(clockid_t, struct timespec*);
  static const Real real = reinterpret_cast<Real>(dlsym(RTLD_NEXT, "clock_gettime"));
  static thread_local unsigned calls = 0;
  const int result = real(clock, time);
  if (result == 0) time->tv_sec += (++calls % 3 == 0 ? -7200 : calls % 3 == 1 ? 3600 : 0);
  return result;
}
