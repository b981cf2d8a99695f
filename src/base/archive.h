// Whole-state save and load: one `archive` member function a class serves checkpoint, resume, undo and the state hash.
#pragma once

#include <cstring>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include <froude/base/aligned.h>
#include <froude/base/api.h>
#include <froude/base/error.h>
#include <froude/base/hash.h>

namespace froude {

/// Visits named values, in a fixed order. A class with state has `void archive(Archive&)` that passes every value on
/// which its future depends; names are unique within one archive (`section` prefixes them). Loading into an object that
/// was built from other definitions is an Error that names the value.
class FROUDE_API Archive {
 public:
  virtual ~Archive() = default;
  virtual bool loading() const = 0;

  /// A block of `count` values of `elementSize` bytes; for a loading archive the destination is already sized.
  virtual void bytes(std::string_view name, void* data, std::size_t elementSize, std::size_t count) = 0;
  /// The count that will be loaded for `name`, or `current` where the archive saves.
  virtual std::size_t count(std::string_view name, std::size_t current) = 0;

  template <typename T>
  void value(std::string_view name, T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes(name, &v, sizeof v, 1);
  }

  template <typename T>
  void array(std::string_view name, AlignedArray<T>& a) {
    const std::size_t n = count(name, a.size());
    if (loading()) a.resize(n);
    bytes(name, a.data(), sizeof(T), n);
  }

  template <typename T>
  void array(std::string_view name, std::vector<T>& a) {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t n = count(name, a.size());
    if (loading()) a.resize(n);
    bytes(name, a.data(), sizeof(T), n);
  }

  /// Prefix for the names that follow, until `endSection`.
  virtual void beginSection(std::string_view name) = 0;
  virtual void endSection() = 0;
};

/// Keeps a state in memory: the undoing of a bad step. Buffers are reused, so a steady step allocates nothing.
class FROUDE_API MemorySnapshot {
 public:
  /// Saves through `visit(Archive&)`, replacing what was kept.
  template <typename Visit>
  void save(Visit&& visit) {
    Writer writer(*this);
    visit(static_cast<Archive&>(writer));
  }
  /// Loads what was saved. Precondition: something was.
  template <typename Visit>
  void load(Visit&& visit) const {
    Reader reader(*this);
    visit(static_cast<Archive&>(reader));
  }
  std::size_t sizeBytes() const { return used_; }

 private:
  class Writer final : public Archive {
   public:
    explicit Writer(MemorySnapshot& s) : snapshot_(s) { s.used_ = 0; }
    bool loading() const override { return false; }
    void bytes(std::string_view, void* data, std::size_t elementSize, std::size_t n) override;
    std::size_t count(std::string_view, std::size_t current) override;
    void beginSection(std::string_view) override {}
    void endSection() override {}

   private:
    MemorySnapshot& snapshot_;
  };
  class Reader final : public Archive {
   public:
    explicit Reader(const MemorySnapshot& s) : snapshot_(s) {}
    bool loading() const override { return true; }
    void bytes(std::string_view name, void* data, std::size_t elementSize, std::size_t n) override;
    std::size_t count(std::string_view name, std::size_t current) override;
    void beginSection(std::string_view) override {}
    void endSection() override {}

   private:
    const MemorySnapshot& snapshot_;
    std::size_t at_ = 0;
  };

  AlignedArray<std::byte> buffer_;
  std::size_t used_ = 0;
};

/// Hashes a state while pretending to save it.
class FROUDE_API HashingArchive final : public Archive {
 public:
  bool loading() const override { return false; }
  void bytes(std::string_view, void* data, std::size_t elementSize, std::size_t n) override {
    hash_.add(data, elementSize * n);
  }
  std::size_t count(std::string_view, std::size_t current) override {
    hash_.addValue(current);
    return current;
  }
  void beginSection(std::string_view) override {}
  void endSection() override {}
  const StateHash& hash() const { return hash_; }

 private:
  StateHash hash_;
};

}  // namespace froude
