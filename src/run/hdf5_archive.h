// State in an HDF5 file: groups for sections, a dataset for each array, one packed table for all that is small.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <froude/base/archive.h>

namespace froude::run {

/// Saves into an HDF5 file in memory, which `finish` turns into bytes. In memory, because HDF5 cannot be relied upon to
/// leave a file that it failed to write to; the bytes then go to disk by writeWholeFile. Blocks of at most 64 bytes are
/// packed into the tables /value_names, /value_sizes and /values: a dataset takes 500 bytes and 20 µs whatever it
/// holds. The file starts with a user block of 512 bytes: a line of text and a checksum of all that follows it.
class Hdf5Writer final : public Archive {
 public:
  Hdf5Writer();
  ~Hdf5Writer() override;

  bool loading() const override { return false; }
  void bytes(std::string_view name, void* data, std::size_t elementSize, std::size_t count) override;
  std::size_t count(std::string_view name, std::size_t current) override;
  void beginSection(std::string_view name) override;
  void endSection() override;

  /// A short text on the root group, for people and for checks before loading.
  void attribute(const std::string& name, const std::string& text);
  /// A text of any length as a dataset.
  void text(const std::string& name, const std::string& text);
  /// The bytes of the file, in two parts that live as long as the writer, which is of no further use.
  std::array<std::string_view, 2> finish();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Loads what Hdf5Writer saved. Throws InputError when the file is not there, is not such a file, or its checksum is
/// wrong; Error when it holds other values than are asked for.
class Hdf5Reader final : public Archive {
 public:
  explicit Hdf5Reader(const std::string& path);
  ~Hdf5Reader() override;

  bool loading() const override { return true; }
  void bytes(std::string_view name, void* data, std::size_t elementSize, std::size_t count) override;
  std::size_t count(std::string_view name, std::size_t current) override;
  void beginSection(std::string_view name) override;
  void endSection() override;

  std::string attribute(const std::string& name) const;
  std::string text(const std::string& name) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Version of the HDF5 library that is running, "1.10.8".
std::string hdf5Version();

}  // namespace froude::run
