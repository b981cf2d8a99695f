#include "study/shares.h"

#include <algorithm>
#include <numeric>

namespace froude::study {

int wantedCores(std::size_t particles, int cores) {
  const std::size_t wanted = (particles + kParticlesPerThread - 1) / kParticlesPerThread;
  return static_cast<int>(std::clamp<std::size_t>(wanted, 1, static_cast<std::size_t>(std::max(cores, 1))));
}

std::vector<int> dealCores(const std::vector<std::size_t>& particles, int cores) {
  std::vector<int> shares(particles.size(), 1);
  for (int free = cores - static_cast<int>(shares.size()); free > 0; --free) {
    std::size_t neediest = shares.size();
    double most = kLeastParticlesPerThread;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      const double each = static_cast<double>(particles[i]) / (shares[i] + 1);
      if (each < most) continue;
      neediest = i;
      most = each;
    }
    if (neediest == shares.size()) break;
    ++shares[neediest];
  }
  return shares;
}

}  // namespace froude::study
