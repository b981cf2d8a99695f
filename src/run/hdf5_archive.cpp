#include "run/hdf5_archive.h"

#include <fmt/format.h>
#include <hdf5.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <fstream>

#include "run/exit_codes.h"

namespace froude::run {
namespace {

constexpr std::size_t kUserBlock = 512;        // smallest that HDF5 knows [bytes]
constexpr std::size_t kPackedUpTo = 64;        // larger blocks are datasets [bytes]
constexpr std::size_t kHashedBlock = 1 << 20;  // [bytes]
constexpr std::size_t kGrowth = 2 << 20;       // of the file in memory [bytes]
constexpr std::string_view kMagic = "froude checkpoint\nchecksum ";

// Owner of an HDF5 handle.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Handle() {
    if (id_ >= 0) close_(id_);
  }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  operator hid_t() const { return id_; }  // NOLINT(google-explicit-constructor): HDF5 takes its handles bare
  bool ok() const { return id_ >= 0; }
  void reset(hid_t id) {
    if (id_ >= 0) close_(id_);
    id_ = id;
  }

 private:
  hid_t id_;
  Close close_;
};

// HDF5 would print its own stack of errors; ours say what matters.
void silenceHdf5() { H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr); }

// Raw bits: the archive knows sizes, not types, and bits are what has to come back.
Handle elementType(std::size_t size) {
  switch (size) {
    case 1:
      return {H5Tcopy(H5T_STD_U8LE), H5Tclose};
    case 2:
      return {H5Tcopy(H5T_STD_U16LE), H5Tclose};
    case 4:
      return {H5Tcopy(H5T_STD_U32LE), H5Tclose};
    case 8:
      return {H5Tcopy(H5T_STD_U64LE), H5Tclose};
    default:
      return {H5Tcreate(H5T_OPAQUE, size), H5Tclose};
  }
}

std::string hashLine(const StateHash& hash) { return std::string(kMagic) + hash.hex() + "\n"; }

// Of all behind the user block, block by block as `checkBody` reads it.
StateHash hashOfBody(std::string_view body) {
  StateHash hash;
  for (std::size_t at = 0; at < body.size(); at += kHashedBlock) {
    const std::string_view block = body.substr(at, kHashedBlock);
    hash.add(block.data(), block.size());
  }
  return hash;
}

// Before HDF5 sees a byte of it: a library that follows offsets in a damaged file may do anything.
void checkBody(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) throw InputError(path + ": cannot be read: " + std::strerror(errno));
  std::string head(kUserBlock, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  if (!in || !head.starts_with(kMagic))
    throw InputError(path + ": this is not a checkpoint of Froude, or its beginning is damaged");
  StateHash hash;
  std::vector<char> block(kHashedBlock);
  while (in) {
    in.read(block.data(), static_cast<std::streamsize>(block.size()));
    if (in.gcount() > 0) hash.add(block.data(), static_cast<std::size_t>(in.gcount()));
  }
  if (!head.starts_with(hashLine(hash))) {
    throw InputError(
        path + ": damaged: its checksum is not that of its contents; restore it from a copy, or start the run again");
  }
}

// Sections prefix names as folders do.
class Path {
 public:
  void push(std::string_view name) { ends_.push_back(text_.size()), text_.append(name).push_back('/'); }
  void pop() { text_.resize(ends_.back()), ends_.pop_back(); }
  std::string of(std::string_view name) const { return text_ + std::string(name); }

 private:
  std::string text_ = "state/";  // apart from the tables and texts at the top
  std::vector<std::size_t> ends_;
};

std::string countName(std::string_view name) { return std::string(name) + "#"; }

}  // namespace

std::string hdf5Version() {
  unsigned major = 0, minor = 0, release = 0;
  H5get_libversion(&major, &minor, &release);
  return fmt::format("{}.{}.{}", major, minor, release);
}

struct Hdf5Writer::Impl {
  Handle access{H5Pcreate(H5P_FILE_ACCESS), H5Pclose};
  Handle links{H5Pcreate(H5P_LINK_CREATE), H5Pclose};
  Handle file{-1, H5Fclose};
  Path path;
  std::string names;
  std::vector<std::uint32_t> sizes;
  std::string values, head;

  void dataset(const std::string& name, const void* data, std::size_t elementSize, std::size_t count) {
    const hsize_t extent = count;
    const Handle space(H5Screate_simple(1, &extent, nullptr), H5Sclose);
    const Handle type = elementType(elementSize);
    const Handle set(H5Dcreate2(file, name.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT), H5Dclose);
    if (!set.ok() || (count > 0 && H5Dwrite(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data) < 0)) {
      throw Error("checkpoint: '" + name + "' cannot be saved; is the name used twice?");
    }
  }
  void pack(const std::string& name, const void* data, std::size_t size) {
    names.append(name).push_back('\n');
    sizes.push_back(static_cast<std::uint32_t>(size));
    if (size > 0) values.append(static_cast<const char*>(data), size);
  }
};

Hdf5Writer::Hdf5Writer() : impl_(std::make_unique<Impl>()) {
  silenceHdf5();
  H5Pset_fapl_core(impl_->access, kGrowth, false);
  // The default, oldest format: newer ones checksum their first block together with a flag for "open", and the image of
  // an open file has the flag cleared but not the checksum (HDF5 1.10.8). Our own checksum covers the whole file.
  H5Pset_create_intermediate_group(impl_->links, 1);
  // HDF5 tells files in memory apart by their names, and several runs of a batch may save at once.
  static std::atomic<unsigned long> number{0};
  impl_->file.reset(
      H5Fcreate(fmt::format("checkpoint {}", ++number).c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, impl_->access));
  if (!impl_->file.ok()) throw Error("checkpoint: HDF5 cannot make a file in memory");
}

Hdf5Writer::~Hdf5Writer() = default;

void Hdf5Writer::bytes(std::string_view name, void* data, std::size_t elementSize, std::size_t count) {
  const std::size_t size = elementSize * count;
  const std::string path = impl_->path.of(name);
  if (size <= kPackedUpTo) {
    impl_->pack(path, data, size);
  } else {
    impl_->dataset(path, data, elementSize, count);
  }
}

std::size_t Hdf5Writer::count(std::string_view name, std::size_t current) {
  const std::uint64_t saved = current;
  impl_->pack(impl_->path.of(countName(name)), &saved, sizeof saved);
  return current;
}

void Hdf5Writer::beginSection(std::string_view name) { impl_->path.push(name); }
void Hdf5Writer::endSection() { impl_->path.pop(); }

void Hdf5Writer::attribute(const std::string& name, const std::string& text) {
  const Handle type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type, std::max<std::size_t>(text.size(), 1));
  H5Tset_strpad(type, H5T_STR_NULLPAD);
  const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
  const Handle made(H5Acreate2(impl_->file, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  if (!made.ok() || H5Awrite(made, type, text.c_str()) < 0) throw Error("checkpoint: '" + name + "' cannot be saved");
}

void Hdf5Writer::text(const std::string& name, const std::string& text) {
  impl_->dataset(name, text.data(), 1, text.size());
}

std::array<std::string_view, 2> Hdf5Writer::finish() {
  text("value_names", impl_->names);
  impl_->dataset("value_sizes", impl_->sizes.data(), sizeof(std::uint32_t), impl_->sizes.size());
  text("values", impl_->values);
  H5Fflush(impl_->file, H5F_SCOPE_LOCAL);
  // The driver's own memory: H5Fget_file_image would make a second copy of all.
  const ssize_t size = H5Fget_file_image(impl_->file, nullptr, 0);
  void* handle = nullptr;
  if (size <= 0 || H5Fget_vfd_handle(impl_->file, H5P_DEFAULT, &handle) < 0) {
    throw Error("checkpoint: HDF5 cannot hand out its file");
  }
  const std::string_view body(*static_cast<const char* const*>(handle), static_cast<std::size_t>(size));
  impl_->head = hashLine(hashOfBody(body));
  impl_->head.resize(kUserBlock, '\0');
  return {impl_->head, body};
}

struct Hdf5Reader::Impl {
  Handle file{-1, H5Fclose};
  std::string source;
  Path path;
  std::string names;
  std::vector<std::uint32_t> sizes;
  std::string values;
  std::size_t nameAt = 0, sizeAt = 0, valueAt = 0;

  // Size of a dataset in bytes and its handle; throws when there is none.
  template <typename Receive>
  void read(const std::string& name, Receive receive) const {
    const Handle set(H5Dopen2(file, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!set.ok()) throw Error(source + ": '" + name + "' is not in the saved state");
    const Handle type(H5Dget_type(set), H5Tclose);
    const Handle space(H5Dget_space(set), H5Sclose);
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    void* target = receive(H5Tget_size(type), static_cast<std::size_t>(std::max<hssize_t>(count, 0)));
    if (count > 0 && H5Dread(set, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, target) < 0) {
      throw InputError(source + ": '" + name + "' cannot be read");
    }
  }
  void unpack(const std::string& name, void* data, std::size_t size) {
    const std::size_t end = names.find('\n', nameAt);
    const std::string saved = end == std::string::npos ? "" : names.substr(nameAt, end - nameAt);
    if (saved != name || sizes[sizeAt] != size) {
      throw Error(source + ": '" + name + "' is wanted, '" + saved + "' was saved: the state belongs to another scene");
    }
    if (size > 0) std::memcpy(data, values.data() + valueAt, size);
    nameAt = end + 1;
    valueAt += sizes[sizeAt++];
  }
};

Hdf5Reader::Hdf5Reader(const std::string& path) : impl_(std::make_unique<Impl>()) {
  silenceHdf5();
  impl_->source = path;
  checkBody(path);
  impl_->file.reset(H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT));
  if (!impl_->file.ok()) throw InputError(path + ": HDF5 cannot open it");
  impl_->names = text("value_names");
  impl_->values = text("values");
  impl_->read("value_sizes", [&](std::size_t, std::size_t count) {
    impl_->sizes.resize(count);
    return static_cast<void*>(impl_->sizes.data());
  });
}

Hdf5Reader::~Hdf5Reader() = default;

void Hdf5Reader::bytes(std::string_view name, void* data, std::size_t elementSize, std::size_t count) {
  const std::string path = impl_->path.of(name);
  if (elementSize * count <= kPackedUpTo) return impl_->unpack(path, data, elementSize * count);
  impl_->read(path, [&](std::size_t savedSize, std::size_t savedCount) {
    if (savedSize != elementSize || savedCount != count) {
      throw Error(impl_->source + ": '" + path + "' was saved with another size: the state belongs to another scene");
    }
    return data;
  });
}

std::size_t Hdf5Reader::count(std::string_view name, std::size_t) {
  std::uint64_t saved = 0;
  impl_->unpack(impl_->path.of(countName(name)), &saved, sizeof saved);
  return saved;
}

void Hdf5Reader::beginSection(std::string_view name) { impl_->path.push(name); }
void Hdf5Reader::endSection() { impl_->path.pop(); }

std::string Hdf5Reader::attribute(const std::string& name) const {
  const Handle found(H5Aopen(impl_->file, name.c_str(), H5P_DEFAULT), H5Aclose);
  if (!found.ok()) throw InputError(impl_->source + ": it does not say its '" + name + "'");
  const Handle type(H5Aget_type(found), H5Tclose);
  std::string text(H5Tget_size(type), '\0');
  if (H5Aread(found, type, text.data()) < 0) throw InputError(impl_->source + ": its '" + name + "' cannot be read");
  return text.substr(0, text.find('\0'));
}

std::string Hdf5Reader::text(const std::string& name) const {
  std::string text;
  impl_->read(name, [&](std::size_t size, std::size_t count) {
    text.resize(size * count);
    return static_cast<void*>(text.data());
  });
  return text;
}

}  // namespace froude::run
