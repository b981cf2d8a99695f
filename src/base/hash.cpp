#include <froude/base/hash.h>

#include <cstring>

namespace froude {
namespace {

std::uint64_t mix(std::uint64_t h) {  // the finaliser of splitmix64 (Steele et al. 2014)
  h ^= h >> 30;
  h *= 0xBF58476D1CE4E5B9ull;
  h ^= h >> 27;
  h *= 0x94D049BB133111EBull;
  return h ^ (h >> 31);
}

// Both halves of a 64 × 64 bit product: one half alone lets the highest bit of a word through unmixed, and a change of
// sign could be undone by one bit of the next word.
std::uint64_t stir(std::uint64_t lane, std::uint64_t word) {
  __extension__ using Wide = unsigned __int128;
  const Wide product = static_cast<Wide>(lane ^ word) * 0x9FB21C651E98DF25ull;
  return static_cast<std::uint64_t>(product) ^ static_cast<std::uint64_t>(product >> 64);
}

std::uint64_t load(const unsigned char* p) {
  std::uint64_t v = 0;
  std::memcpy(&v, p, sizeof v);
  return v;
}

}  // namespace

void StateHash::add(const void* data, std::size_t bytes) {
  const auto* p = static_cast<const unsigned char*>(data);
  std::uint64_t lane[4] = {state_, state_ ^ 0xA0761D6478BD642Full, ~state_, state_ + bytes};
  std::size_t left = bytes;
  for (; left >= 32; left -= 32, p += 32) {  // four independent lanes: memory speed, not multiplication latency
    for (int k = 0; k < 4; ++k) lane[k] = stir(lane[k], load(p + 8 * k));
  }
  for (; left >= 8; left -= 8, p += 8) lane[0] = stir(lane[0], load(p));
  std::uint64_t tail = 0;
  if (left > 0) std::memcpy(&tail, p, left);
  lane[1] ^= tail * 0x9FB21C651E98DF25ull;
  state_ = mix(lane[0]) ^ mix(lane[1] + 1) ^ mix(lane[2] + 2) ^ mix(lane[3] + 3 + bytes);
}

std::uint64_t StateHash::value() const { return mix(state_); }

std::string StateHash::hex() const {
  static constexpr char kDigits[] = "0123456789abcdef";
  std::string text(16, '0');
  std::uint64_t v = value();
  for (int i = 15; i >= 0; --i, v >>= 4) text[static_cast<std::size_t>(i)] = kDigits[v & 15];
  return text;
}

}  // namespace froude
