// A deliberate data race between the bodies of one loop: a build with the thread sanitizer must end here with an error,
// or the suppressions hide what they are not meant to hide.
#include <froude/base/parallel.h>
#include <tbb/task_arena.h>

#include <cstddef>
#include <cstdio>

int main() {
  double sum = 0.0;
  tbb::task_arena arena(4);
  arena.execute([&] {
    froude::parallelFor(1 << 22, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) sum += static_cast<double>(i);
    });
  });
  std::printf("%g\n", sum);
  return 0;
}
