// A growable array of plain values on 64-byte boundaries, padded so that a full SIMD vector may be read past the end.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <new>
#include <span>
#include <type_traits>
#include <utility>

namespace froude {

/// Bytes that may be read (never relied upon) before the first and behind the last element.
inline constexpr std::size_t kSimdPadding = 64;

/// Owner of `size()` trivially copyable elements. Growing keeps the contents; shrinking never frees. Elements that
/// growing adds are zero.
template <typename T>
class AlignedArray {
  static_assert(std::is_trivially_copyable_v<T>);

 public:
  AlignedArray() = default;
  explicit AlignedArray(std::size_t size) { resize(size); }
  AlignedArray(AlignedArray&& other) noexcept { swap(other); }
  AlignedArray& operator=(AlignedArray&& other) noexcept {
    swap(other);
    return *this;
  }
  AlignedArray(const AlignedArray& other) { assign(other.span()); }
  AlignedArray& operator=(const AlignedArray& other) {
    if (this != &other) assign(other.span());
    return *this;
  }
  ~AlignedArray() { release(); }

  T* data() { return data_; }
  const T* data() const { return data_; }
  std::size_t size() const { return size_; }
  std::size_t capacity() const { return capacity_; }
  bool empty() const { return size_ == 0; }
  T& operator[](std::size_t i) { return data_[i]; }
  const T& operator[](std::size_t i) const { return data_[i]; }
  T* begin() { return data_; }
  T* end() { return data_ + size_; }
  const T* begin() const { return data_; }
  const T* end() const { return data_ + size_; }
  std::span<T> span() { return {data_, size_}; }
  std::span<const T> span() const { return {data_, size_}; }

  void clear() { size_ = 0; }

  void reserve(std::size_t capacity) {
    if (capacity <= capacity_) return;
    const std::size_t bytes = capacity * sizeof(T) + 2 * kSimdPadding;
    auto* raw = static_cast<std::byte*>(::operator new (bytes, std::align_val_t{64}));
    std::memset(raw, 0, bytes);
    T* fresh = reinterpret_cast<T*>(raw + kSimdPadding);
    if (size_ > 0) std::memcpy(static_cast<void*>(fresh), data_, size_ * sizeof(T));
    release();
    data_ = fresh;
    capacity_ = capacity;
  }

  /// Geometric growth, so that repeated `resize` by one is amortised.
  void resize(std::size_t size) {
    if (size > capacity_) reserve(size > 2 * capacity_ ? size : 2 * capacity_);
    if (size > size_) std::memset(static_cast<void*>(data_ + size_), 0, (size - size_) * sizeof(T));
    size_ = size;
  }

  void push_back(const T& value) {
    const T copy = value;
    resize(size_ + 1);
    data_[size_ - 1] = copy;
  }

  /// Gives unused memory back. Cost: one copy.
  void shrink() {
    if (capacity_ == size_) return;
    AlignedArray smaller;
    if (size_ > 0) smaller.reserve(size_);
    smaller.resize(size_);
    if (size_ > 0) std::memcpy(static_cast<void*>(smaller.data_), data_, size_ * sizeof(T));
    swap(smaller);
  }

  void assign(std::span<const T> values) {
    resize(values.size());
    if (!values.empty()) std::memcpy(static_cast<void*>(data_), values.data(), values.size_bytes());
  }

  void swap(AlignedArray& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    std::swap(capacity_, other.capacity_);
  }

 private:
  void release() {
    if (data_ != nullptr) ::operator delete (reinterpret_cast<std::byte*>(data_) - kSimdPadding, std::align_val_t{64});
    data_ = nullptr;
  }

  T* data_ = nullptr;
  std::size_t size_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace froude
