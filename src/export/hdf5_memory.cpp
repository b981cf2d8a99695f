#include "export/hdf5_memory.h"

#include <algorithm>
#include <atomic>
#include <string_view>

#include "export/frames.h"
#include "run/atomic_file.h"

namespace froude::exporting {
namespace {

hid_t createInMemory(const std::string& name, std::size_t growth) {
  // HDF5 would print its own stack of errors; ours say what matters.
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  const Hdf5Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "HDF5");
  checkHdf5(H5Pset_fapl_core(access, growth, false), "HDF5");
  // HDF5 tells files in memory apart by their names, and several runs of a batch write the same frames.
  static std::atomic<unsigned long> number{0};
  return H5Fcreate((name + "#" + std::to_string(++number)).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, access);
}

void writeScalar(hid_t object, const char* name, hid_t type, hid_t fileType, const void* value) {
  const Hdf5Handle space(H5Screate(H5S_SCALAR), H5Sclose, name);
  const Hdf5Handle attribute(H5Acreate2(object, name, fileType, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose, name);
  checkHdf5(H5Awrite(attribute, type, value), name);
}

}  // namespace

Hdf5Handle::Hdf5Handle(hid_t id, Close close, const std::string& what) : id_(id), close_(close) {
  if (id < 0) throw OutputError(what + ": HDF5 cannot write it; memory may be short");
}

void checkHdf5(herr_t result, const std::string& what) {
  if (result < 0) throw OutputError(what + ": HDF5 cannot write it; memory may be short");
}

Hdf5Memory::Hdf5Memory(const std::string& name, std::size_t growth)
    : file_(createInMemory(name, growth), H5Fclose, name) {}

std::size_t Hdf5Memory::bytes() const {
  return static_cast<std::size_t>(std::max<ssize_t>(0, H5Fget_file_image(file_, nullptr, 0)));
}

void Hdf5Memory::save(const std::string& path) {
  checkHdf5(H5Fflush(file_, H5F_SCOPE_GLOBAL), path);
  // The driver's own memory: an image by H5Fget_file_image would be a second copy of all frames.
  void* handle = nullptr;
  checkHdf5(H5Fget_vfd_handle(file_, H5P_DEFAULT, &handle), path);
  run::writeWholeFile(path, {*static_cast<const char* const*>(handle), bytes()});
}

void writeColumn(hid_t group, const Hdf5Column& column) {
  const Hdf5Handle space(H5Screate_simple(column.shape[1] > 1 ? 2 : 1, column.shape.data(), nullptr), H5Sclose,
                         column.name);
  const Hdf5Handle set(H5Dcreate2(group, column.name, column.fileType, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
                       H5Dclose, column.name);
  if (column.shape[0] > 0)
    checkHdf5(H5Dwrite(set, column.type, H5S_ALL, H5S_ALL, H5P_DEFAULT, column.data), column.name);
  if (*column.unit != 0) writeAttribute(set, "unit", column.unit);
}

void writeAttribute(hid_t object, const char* name, const std::string& text) {
  const Hdf5Handle type(H5Tcopy(H5T_C_S1), H5Tclose, name);
  checkHdf5(H5Tset_size(type, text.size() + 1), name);
  checkHdf5(H5Tset_cset(type, H5T_CSET_UTF8), name);
  writeScalar(object, name, type, type, text.c_str());
}

void writeAttribute(hid_t object, const char* name, double value) {
  writeScalar(object, name, H5T_NATIVE_DOUBLE, H5T_IEEE_F64LE, &value);
}

void writeAttribute(hid_t object, const char* name, int value) {
  writeScalar(object, name, H5T_NATIVE_INT, H5T_STD_I32LE, &value);
}

}  // namespace froude::exporting
