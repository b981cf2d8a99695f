#include <froude/base/archive.h>
#include <gtest/gtest.h>

#include <vector>

namespace {

using namespace froude;

struct Thing {
  double a = 1.5;
  std::vector<int> list{1, 2, 3};
  AlignedArray<float> column;

  void archive(Archive& archive) {
    archive.beginSection("thing");
    archive.value("a", a);
    archive.array("list", list);
    archive.array("column", column);
    archive.endSection();
  }
};

const auto visit = [](Thing& thing) { return [&thing](Archive& a) { thing.archive(a); }; };

TEST(MemorySnapshot, loads_what_it_saved_whatever_happened_in_between) {
  Thing thing;
  thing.column.push_back(0.25f);
  MemorySnapshot snapshot;
  snapshot.save(visit(thing));
  thing.a = 7.0;
  thing.list = {9, 9, 9, 9, 9};
  thing.column.clear();
  snapshot.load(visit(thing));
  EXPECT_EQ(thing.a, 1.5);
  EXPECT_EQ(thing.list, (std::vector<int>{1, 2, 3}));
  ASSERT_EQ(thing.column.size(), 1u);
  EXPECT_EQ(thing.column[0], 0.25f);
}

TEST(MemorySnapshot, a_second_save_replaces_the_first) {
  Thing thing;
  MemorySnapshot snapshot;
  snapshot.save(visit(thing));
  const std::size_t size = snapshot.sizeBytes();
  thing.a = 2.5;
  thing.list = {4};
  snapshot.save(visit(thing));
  EXPECT_LT(snapshot.sizeBytes(), size);
  Thing other;
  snapshot.load(visit(other));
  EXPECT_EQ(other.a, 2.5);
  EXPECT_EQ(other.list, std::vector<int>{4});
}

TEST(MemorySnapshot, a_value_that_was_never_saved_is_an_error_that_names_it) {
  MemorySnapshot snapshot;
  int v = 3;
  snapshot.save([&](Archive& a) { a.value("first", v); });
  try {
    snapshot.load([&](Archive& a) {
      a.value("first", v);
      a.value("second", v);
    });
    FAIL();
  } catch (const Error& e) {
    EXPECT_NE(std::string(e.what()).find("'second'"), std::string::npos) << e.what();
  }
}

TEST(HashingArchive, equal_states_hash_alike_and_others_do_not) {
  const auto hash = [](Thing thing) {
    HashingArchive archive;
    thing.archive(archive);
    return archive.hash().value();
  };
  Thing a, b;
  EXPECT_EQ(hash(a), hash(b));
  b.list.back() = 4;
  EXPECT_NE(hash(a), hash(b));
  b = a;
  b.list.push_back(0);
  EXPECT_NE(hash(a), hash(b));
}

}  // namespace
