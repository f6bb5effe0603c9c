#include "core/base/copy_on_write.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace remesh {
namespace {

using Numbers = CopyOnWrite<std::size_t, int>;

TEST(copy_on_write, it_looks_at_others_items_until_it_is_changed) {
  const std::vector<int> others = {1, 2, 3};
  Numbers items = Numbers::of(others);
  EXPECT_EQ(items.items().data(), others.data());
  items.change([](std::vector<int>& own) { own.push_back(4); });
  EXPECT_EQ(items, (std::vector<int>{1, 2, 3, 4}));
  EXPECT_EQ(others, (std::vector<int>{1, 2, 3}));
  // From now on they are its own, and stay in their place.
  const int* const place = items.items().data();
  items.change([](std::vector<int>& own) { own[0] = 5; });
  EXPECT_EQ(items.items().data(), place);
  EXPECT_EQ(items[0], 5);
}

TEST(copy_on_write, once_detached_it_outlives_the_others) {
  std::optional<std::vector<int>> others({1, 2, 3});
  Numbers items = Numbers::of(*others);
  items.detach();
  others.reset();
  EXPECT_EQ(items, (std::vector<int>{1, 2, 3}));
}

TEST(copy_on_write, copies_and_moved_ones_have_their_own_or_look_at_the_same) {
  const std::vector<int> others = {7, 8};
  std::optional<Numbers> own(std::in_place, std::vector<int>{1, 2}), looking(Numbers::of(others));
  const Numbers copy_of_own = *own, copy_of_looking = *looking;
  EXPECT_NE(copy_of_own.items().data(), own->items().data());
  EXPECT_EQ(copy_of_looking.items().data(), others.data());
  Numbers moved = std::move(*own), assigned;
  assigned = std::move(*looking);
  EXPECT_TRUE(own->empty());
  own.reset();
  looking.reset();
  EXPECT_EQ(moved, (std::vector<int>{1, 2}));
  EXPECT_EQ(copy_of_own, (std::vector<int>{1, 2}));
  EXPECT_EQ(assigned.items().data(), others.data());
  assigned = std::vector<int>{9};
  EXPECT_EQ(assigned, (std::vector<int>{9}));
  EXPECT_EQ(others, (std::vector<int>{7, 8}));
}

TEST(copy_on_write, it_is_asked_by_the_kind_of_id_it_is_for) {
  const std::vector<int> others = {4, 5};
  const auto items = CopyOnWrite<VertexId, int>::of(others);
  EXPECT_EQ(items[VertexId(1)], 5);
  EXPECT_EQ(items.size(), 2u);
  EXPECT_FALSE(items.empty());
  EXPECT_TRUE((CopyOnWrite<VertexId, int>().empty()));
}

}  // namespace
}  // namespace remesh
