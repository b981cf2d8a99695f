// State in HDF5: what comes back is what went in, and what is damaged is not taken.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <froude/base/random.h>
#include "run/atomic_file.h"
#include "run/exit_codes.h"
#include "run/hdf5_archive.h"

namespace froude::run {
namespace {

// Something with state: values and arrays of many sizes, in sections.
struct Thing {
  double x = 0.0;
  std::uint8_t flag = 0;
  std::vector<float> none, few, many;
  AlignedArray<double> aligned;
  std::vector<std::array<double, 3>> triples;
  std::vector<std::uint16_t> shorts;

  void archive(Archive& a) {
    a.beginSection("outer");
    a.value("x", x);
    a.array("none", none);
    a.beginSection("inner");
    a.array("few", few);
    a.array("many", many);
    a.endSection();
    a.array("aligned", aligned);
    a.array("triples", triples);
    a.endSection();
    a.array("shorts", shorts);
    a.value("flag", flag);
  }
};

Thing makeThing() {
  Thing t;
  RandomStream random(5, 1);
  t.x = -0.0;
  t.flag = 200;
  t.few = {1.5f, std::numeric_limits<float>::quiet_NaN(), -std::numeric_limits<float>::denorm_min()};
  for (int i = 0; i < 10000; ++i) t.many.push_back(static_cast<float>(random.uniform()));
  t.aligned.resize(777);
  for (double& v : t.aligned) v = random.uniform(-1e300, 1e300);
  for (int i = 0; i < 50; ++i) t.triples.push_back({random.uniform(), random.uniform(), random.uniform()});
  for (int i = 0; i < 100; ++i) t.shorts.push_back(static_cast<std::uint16_t>(random.below(65536)));
  return t;
}

std::string hashOf(Thing& t) {
  HashingArchive hashing;
  t.archive(hashing);
  return hashing.hash().hex();
}

class Hdf5State : public testing::Test {
 protected:
  Hdf5State() {
    std::string pattern = (std::filesystem::temp_directory_path() / "froude-state-XXXXXX").string();
    folder_ = mkdtemp(pattern.data());
    file_ = folder_ + "/checkpoint.h5";
    Hdf5Writer writer;
    writer.attribute("simd", "avx2");
    writer.attribute("empty", "");
    writer.text("run", "{\"ä\": 1}");
    thing_ = makeThing();
    thing_.archive(writer);
    writeWholeFile(file_, writer.finish());
  }
  ~Hdf5State() override { std::filesystem::remove_all(folder_); }

  void damage(std::size_t at) {
    std::string bytes = readWholeFile(file_);
    bytes[at] = static_cast<char>(bytes[at] ^ 1);
    writeWholeFile(file_, bytes);
  }

  std::string folder_, file_;
  Thing thing_;
};

TEST_F(Hdf5State, every_bit_comes_back) {
  Hdf5Reader reader(file_);
  Thing loaded;
  loaded.few = {9.f, 9.f, 9.f, 9.f, 9.f};
  loaded.archive(reader);
  EXPECT_EQ(hashOf(loaded), hashOf(thing_));
  EXPECT_TRUE(std::signbit(loaded.x));
  EXPECT_EQ(loaded.shorts, thing_.shorts);
  EXPECT_EQ(loaded.many, thing_.many);
}

TEST_F(Hdf5State, texts_and_attributes_come_back) {
  const Hdf5Reader reader(file_);
  EXPECT_EQ(reader.attribute("simd"), "avx2");
  EXPECT_EQ(reader.attribute("empty"), "");
  EXPECT_EQ(reader.text("run"), "{\"ä\": 1}");
  EXPECT_THROW(reader.attribute("absent"), InputError);
  EXPECT_THROW(reader.text("absent"), Error);
}

TEST_F(Hdf5State, one_changed_bit_anywhere_is_found) {
  const std::size_t size = std::filesystem::file_size(file_);
  RandomStream random(7, 0);
  for (int i = 0; i < 50; ++i) {
    const std::size_t at = 512 + random.below(static_cast<std::uint32_t>(size - 512));
    damage(at);
    EXPECT_THROW(Hdf5Reader{file_}, InputError) << "byte " << at;
    damage(at);
  }
  EXPECT_NO_THROW(Hdf5Reader{file_});
}

TEST_F(Hdf5State, a_truncated_an_empty_and_a_foreign_file_are_refused) {
  std::filesystem::resize_file(file_, std::filesystem::file_size(file_) - 1);
  EXPECT_THROW(Hdf5Reader{file_}, InputError);
  std::filesystem::resize_file(file_, 600);
  EXPECT_THROW(Hdf5Reader{file_}, InputError);
  std::filesystem::resize_file(file_, 0);
  EXPECT_THROW(Hdf5Reader{file_}, InputError);
  writeWholeFile(file_, std::string(2000, 'x'));
  EXPECT_THROW(Hdf5Reader{file_}, InputError);
  EXPECT_THROW(Hdf5Reader{folder_ + "/absent.h5"}, InputError);
}

TEST_F(Hdf5State, a_state_of_other_things_is_an_error_that_names_them) {
  Hdf5Reader reader(file_);
  double y = 0.0;
  reader.beginSection("outer");
  try {
    reader.value("y", y);
    FAIL() << "no error";
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("outer/y"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("outer/x"), std::string::npos) << e.what();
  }
}

TEST_F(Hdf5State, an_array_of_another_size_is_an_error) {
  Hdf5Writer writer;
  std::vector<double> values(100, 1.0);
  writer.bytes("values", values.data(), sizeof(double), values.size());
  writeWholeFile(file_, writer.finish());
  Hdf5Reader reader(file_);
  std::vector<double> fewer(99);
  EXPECT_THROW(reader.bytes("values", fewer.data(), sizeof(double), fewer.size()), Error);
}

TEST_F(Hdf5State, a_large_array_under_a_name_that_is_taken_is_an_error) {
  Hdf5Writer writer;
  std::vector<double> values(100, 1.0);
  writer.bytes("values", values.data(), sizeof(double), values.size());
  EXPECT_THROW(writer.bytes("values", values.data(), sizeof(double), values.size()), Error);
}

}  // namespace
}  // namespace froude::run
