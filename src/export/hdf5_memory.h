// HDF5 files made in memory and written whole: the library crashes or loops when a write to a full disk fails under it.
#pragma once

#include <hdf5.h>

#include <array>
#include <span>
#include <string>
#include <utility>

#include <froude/base/error.h>

namespace froude::exporting {

/// Owner of an HDF5 handle. Throws OutputError "WHAT: …" for a handle that HDF5 refused to make.
class Hdf5Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle(hid_t id, Close close, const std::string& what);
  ~Hdf5Handle() { close_(id_); }
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): HDF5 takes its handles bare

 private:
  hid_t id_;
  Close close_;
};

/// Throws OutputError "WHAT: HDF5 cannot write it" for a negative result.
void checkHdf5(herr_t result, const std::string& what);

/// An HDF5 file in memory.
class Hdf5Memory {
 public:
  /// `name` is for messages; `growth`: bytes by which its memory grows.
  Hdf5Memory(const std::string& name, std::size_t growth);
  hid_t id() const { return file_; }
  /// Bytes that the file would have now.
  std::size_t bytes() const;
  /// Writes the file beside and renames it. Throws OutputError.
  void save(const std::string& path);

 private:
  Hdf5Handle file_;
};

/// A dataset of `shape` = {rows, columns}, columns = 1 for a plain list, of HDF5 type `type` in memory; little-endian
/// `fileType` in the file; with its unit as an attribute.
struct Hdf5Column {
  const char* name;
  const char* unit;
  hid_t type, fileType;
  std::array<hsize_t, 2> shape;
  const void* data;
};
void writeColumn(hid_t group, const Hdf5Column& column);

void writeAttribute(hid_t object, const char* name, const std::string& text);
void writeAttribute(hid_t object, const char* name, double value);
void writeAttribute(hid_t object, const char* name, int value);

}  // namespace froude::exporting
