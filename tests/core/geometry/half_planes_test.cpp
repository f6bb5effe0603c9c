#include "core/geometry/intersections/half_planes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "core/geometry/triangles/triangle_intersection.h"
#include "tests/support/random.h"

namespace remesh {
namespace {

/// A book of pages with given apexes. The edge is from positions[0] to positions[1].
struct Book {
  std::vector<Vec3> positions;
  std::vector<Page> pages;

  Book(const Vec3& from, const Vec3& to) : positions{from, to} {}
  void add(const Vec3& apex) {
    pages.push_back({VertexId(positions.size()), FaceId(pages.size())});
    positions.push_back(apex);
  }
  std::vector<std::vector<FaceId>> groups() const {
    RunControl control;
    std::vector<Page> sorted = pages;
    const auto ends = group_by_half_plane(positions[0], positions[1], positions, sorted, control);
    std::vector<std::vector<FaceId>> result;
    std::size_t i = 0;
    for (const std::size_t end : ends)
      for (result.emplace_back(); i < end; ++i) result.back().push_back(sorted[i].face);
    EXPECT_EQ(i, pages.size());
    return result;
  }
  Triangle triangle(FaceId f) const { return {VertexId(0), VertexId(1), pages[f.value].apex}; }
};

TEST(half_planes, pages_meet_beside_their_edge_if_they_are_of_one_group) {
  for (int seed = 0; seed < 30; ++seed) {
    Random random(seed);
    const auto point = [&] { return Vec3{1.0 * random.below(5), 1.0 * random.below(5), 1.0 * random.below(5)}; };
    const double factor = seed % 3 == 0 ? 1 : std::ldexp(1, seed % 3 == 1 ? 240 : -240);
    const Vec3 from = point();
    Vec3 to = point();
    while (to == from) to = point();
    std::set<Vec3> places{from, to};
    Book book(factor * from, factor * to);
    for (int i = 0; i < 60; ++i)
      if (const Vec3 p = point(); places.insert(p).second) book.add(factor * p);
    std::vector<int> group_of(book.pages.size());
    int n = 0;
    for (const auto& group : book.groups()) {
      EXPECT_TRUE(std::is_sorted(group.begin(), group.end()));
      for (const FaceId f : group) group_of[f.value] = n;
      ++n;
    }
    for (std::uint32_t f = 0; f < group_of.size(); ++f)
      for (std::uint32_t g = f + 1; g < group_of.size(); ++g) {
        const bool do_meet = do_intersect(book.triangle(FaceId(f)), book.triangle(FaceId(g)), book.positions);
        EXPECT_EQ(do_meet, group_of[f] == group_of[g]) << seed << ' ' << f << ' ' << g;
      }
  }
}

TEST(half_planes, the_least_angle_makes_another_one) {
  Book book({0, 0, 0}, {0, 0, 1});
  for (const double y : {0.0, 0x1p-52, -0x1p-52, 0x1p-1 + 0x1p-53, 0x1p-1}) {
    book.add({1, y, 0.3});
    book.add({-1, y, 0.7});
    book.add({2, 2 * y, 0.3});
  }
  EXPECT_EQ(book.groups().size(), 10u);
}

TEST(half_planes, of_no_pages_there_are_no_groups) { EXPECT_TRUE(Book({0, 0, 0}, {0, 0, 1}).groups().empty()); }

TEST(half_planes, a_stop_is_obeyed) {
  Book book({0, 0, 0}, {0, 0, 1});
  for (int i = 0; i < 100'000; ++i) book.add({std::cos(7.0 * i), std::sin(7.0 * i), 0});
  RunControl control;
  control.cancel();
  EXPECT_THROW(group_by_half_plane(book.positions[0], book.positions[1], book.positions, book.pages, control), Error);
}

}  // namespace
}  // namespace remesh
