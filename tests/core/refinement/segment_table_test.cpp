#include "core/refinement/segments/segment_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "tests/support/invariance.h"
#include "tests/support/shapes.h"
#include "tests/support/solids.h"
#include "tests/support/stage_chain.h"

namespace remesh {
namespace {

constexpr double kNoSize = std::numeric_limits<double>::infinity();

Goals goals(double min_edge_length = 0) {
  Options options;
  if (min_edge_length > 0) options.min_edge_length = min_edge_length;
  return goals_of(options, 1);
}

/// The segments of a surface and what they were made from.
struct TableSubject {
  explicit TableSubject(const PolygonMesh& mesh, const Goals& goals = remesh::goals_of({}, 1), double size = kNoSize,
                        double tolerance = 1e-6)
      : chain(mesh, tolerance), sizes(size), frozen(chain.meshes.size()), table(make(goals)) {}

  SegmentTable make(const Goals& goals) {
    SegmentTable table(chain.surface, chain.triangulated, frozen, sizes, goals, chain.control);
    table.plan_cuts(chain.triangulated, sizes, goals, chain.control);
    return table;
  }
  SegmentId between(const Vec3& a, const Vec3& b) const {
    for (std::uint32_t s = 0; s < table.size(); ++s) {
      const std::set<VertexId> ends{table[SegmentId(s)].from, table[SegmentId(s)].to};
      if (ends == std::set<VertexId>{chain.at(a), chain.at(b)}) return SegmentId(s);
    }
    ADD_FAILURE() << "no segment there";
    return SegmentId(0);
  }
  /// How far from that end the piece next to it is cut, if only there is a cut: on the whole segment at first, then on
  /// what is left at that end.
  std::vector<double> rings_at(const Vec3& end, SegmentId s) const {
    std::vector<double> rings;
    const bool is_from = table[s].from == chain.at(end);
    for (double t = is_from ? 1 : 0;;) {
      const auto cut = is_from ? table.cut(s, 0, t) : table.cut(s, t, 1);
      if (!cut) return rings;
      t = *cut;
      rings.push_back((is_from ? t : 1 - t) * table[s].length);
    }
  }

  StageChain chain;
  SizeField sizes;
  IdVector<PatchId, std::uint8_t> frozen;
  SegmentTable table;
};

/// Returns all places, ascending, at which a segment can ever be cut, as long as the pieces stay longer than `least`.
std::vector<double> all_cuts(const SegmentTable& table, SegmentId s, double least = 0) {
  std::vector<double> places;
  std::vector<std::pair<double, double>> pieces{{0, 1}};
  while (!pieces.empty()) {
    const auto [t0, t1] = pieces.back();
    pieces.pop_back();
    if ((t1 - t0) * table[s].length < least) continue;
    const auto cut = table.cut(s, t0, t1);
    if (!cut) continue;
    EXPECT_GT(*cut, t0);
    EXPECT_LT(*cut, t1);
    places.push_back(*cut);
    pieces.push_back({t0, *cut});
    pieces.push_back({*cut, t1});
  }
  std::sort(places.begin(), places.end());
  return places;
}

double shortest_piece(const std::vector<double>& cuts, double length) {
  double shortest = length, last = 0;
  for (const double t : cuts) {
    shortest = std::min(shortest, (t - last) * length);
    last = t;
  }
  return std::min(shortest, (1 - last) * length);
}

double longest_piece(const std::vector<double>& cuts, double length) {
  double longest = 0, last = 0;
  for (const double t : cuts) {
    longest = std::max(longest, (t - last) * length);
    last = t;
  }
  return std::max(longest, (1 - last) * length);
}

TEST(segment_table, a_box_has_twelve_segments_of_two_sides_each) {
  const TableSubject subject(shapes::box({1, 2, 3}, 2));
  ASSERT_EQ(subject.table.size(), 12u);
  EXPECT_EQ(subject.table.all_sides().size(), 24u);
  std::multiset<double> lengths;
  for (std::uint32_t s = 0; s < 12; ++s) {
    const BoundarySegment& segment = subject.table[SegmentId(s)];
    lengths.insert(segment.length);
    EXPECT_LT(subject.chain.surface.positions[segment.from], subject.chain.surface.positions[segment.to]);
    EXPECT_EQ(segment.ring_base[0], 0) << "right angles need no rings";
    EXPECT_EQ(segment.ring_base[1], 0);
    EXPECT_FALSE(segment.is_locked());
    const auto sides = subject.table.sides(SegmentId(s));
    ASSERT_EQ(sides.size(), 2u);
    EXPECT_LT(sides[0].patch, sides[1].patch);
    for (const SegmentSide& side : sides) {
      const PatchMesh& patch = subject.chain.meshes[side.patch];
      const std::set<VertexId> ends{patch.vertices[patch.mesh.from(side.half_edge)],
                                    patch.vertices[patch.mesh.to(side.half_edge)]};
      EXPECT_EQ(ends, (std::set<VertexId>{segment.from, segment.to}));
    }
  }
  EXPECT_EQ(lengths, (std::multiset<double>{1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3}));
  for (std::uint32_t p = 0; p < 6; ++p) EXPECT_EQ(subject.table.sides_of_patch(PatchId(p)).size(), 4u);
}

TEST(segment_table, an_edge_of_three_patches_is_one_segment) {
  const TableSubject subject(shapes::three_pages());
  ASSERT_EQ(subject.table.size(), 10u);
  EXPECT_EQ(subject.table.sides(subject.between({0, 0, 0}, {0, 0, 1})).size(), 3u);
}

TEST(segment_table, an_edge_with_one_patch_on_both_sides_is_one_segment) {
  // A plate with a fin, whose foot is in the plate's inside.
  const TableSubject subject(
      shapes::from_lists({{0, 0, 0}, {4, 0, 0}, {4, 4, 0}, {0, 4, 0}, {1, 2, 0}, {3, 2, 0}, {3, 2, 1}, {1, 2, 1}},
                         {{0, 1, 4}, {1, 5, 4}, {1, 2, 5}, {2, 3, 5}, {3, 4, 5}, {3, 0, 4}, {4, 5, 6}, {4, 6, 7}}));
  const auto sides = subject.table.sides(subject.between({1, 2, 0}, {3, 2, 0}));
  ASSERT_EQ(sides.size(), 3u);
  EXPECT_EQ(std::set<PatchId>({sides[0].patch, sides[1].patch, sides[2].patch}).size(), 2u);
}

TEST(segment_table, where_no_segment_is_near_a_piece_is_cut_in_the_middle) {
  const TableSubject subject(shapes::box({1, 1, 1}));
  for (std::uint32_t s = 0; s < 12; ++s) {
    EXPECT_EQ(subject.table.cut(SegmentId(s), 0, 1), 0.5);
    EXPECT_EQ(subject.table.cut(SegmentId(s), 0.25, 0.5), 0.375);
  }
}

TEST(segment_table, segments_at_a_small_angle_are_cut_on_common_shells) {
  for (const double degrees : {1.0, 20.0, 59.0}) {
    // The small angle at the origin, with sides of 5 and 3; all other angles are right or more.
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3 first_end{5, 0, 0}, second_end{3 * std::cos(angle), 3 * std::sin(angle), 0};
    const TableSubject subject(shapes::polygon({{0, 0},
                                                {5, 0},
                                                {5, 5},
                                                {second_end.x - std::sin(angle), second_end.y + std::cos(angle)},
                                                {second_end.x, second_end.y}}));
    const std::vector<double> on_first = subject.rings_at({0, 0, 0}, subject.between({0, 0, 0}, first_end)),
                              on_second = subject.rings_at({0, 0, 0}, subject.between({0, 0, 0}, second_end));
    ASSERT_GE(on_first.size(), 2u) << degrees;
    ASSERT_GE(on_second.size(), 2u) << degrees;
    // A third of the shortest segment, times a power of two.
    for (const auto& rings : {on_first, on_second})
      for (std::size_t i = 0; i < rings.size(); ++i) {
        const double octave = std::log2(rings[i]);
        EXPECT_NEAR(octave, std::round(octave), 1e-9) << degrees;
        if (i > 0) {
          EXPECT_NEAR(rings[i] / rings[i - 1], 0.5, 1e-9) << degrees;
        }
      }
    // The pieces on both sides of the first cut are long enough.
    EXPECT_GE(on_first[0], 5.0 / 4);
    EXPECT_LE(on_first[0], 5.0 * 3 / 4);
  }
}

TEST(segment_table, at_sixty_degrees_there_are_no_shells) {
  const TableSubject subject(shapes::triangle(60, 1, 1));
  for (std::uint32_t s = 0; s < 3; ++s) EXPECT_EQ(subject.table[SegmentId(s)].ring_base[0], 0);
}

TEST(segment_table, a_cluster_reaches_over_all_patches_around_a_vertex) {
  // 20 facets, each with its own two spokes at a small angle: one cluster, one base, a third of the shortest spoke.
  PolygonMesh fan = solids::needle_fan(20, 2);
  Vec3& tip = fan.positions[VertexId(5)];
  tip = 0.5 * tip;
  const TableSubject subject(fan);
  const double expected = norm(tip) / 3;
  for (std::uint32_t v = 1; v <= 21; ++v) {
    const SegmentId s = subject.between({0, 0, 0}, fan.positions[VertexId(v)]);
    const bool is_from = subject.table[s].from == subject.chain.at({0, 0, 0});
    EXPECT_DOUBLE_EQ(subject.table[s].ring_base[is_from ? 0 : 1], expected) << v;
  }
}

TEST(segment_table, angles_of_different_patches_at_a_vertex_are_different_clusters) {
  // Two sharp corners that share only their tip.
  const PolygonMesh mesh =
      shapes::from_lists({{0, 0, 0}, {3, 0, 0}, {3, 1, 0}, {-6, 0, 0}, {-6, -1, 1}}, {{0, 1, 2}, {0, 3, 4}});
  const TableSubject subject(mesh);
  const auto base = [&](std::uint32_t v) {
    const SegmentId s = subject.between({0, 0, 0}, mesh.positions[VertexId(v)]);
    return subject.table[s].ring_base[subject.table[s].from == subject.chain.at({0, 0, 0}) ? 0 : 1];
  };
  EXPECT_DOUBLE_EQ(base(1), 1);
  EXPECT_DOUBLE_EQ(base(2), 1);
  EXPECT_DOUBLE_EQ(base(3), 2);
  EXPECT_DOUBLE_EQ(base(4), 2);
}

TEST(segment_table, no_cut_makes_a_piece_shorter_than_the_floor) {
  for (const PolygonMesh& mesh : {shapes::box({1, 2, 3}), shapes::triangle(3, 1, 1.3), solids::needle_fan(5, 10)}) {
    const TableSubject subject(mesh);
    for (std::uint32_t s = 0; s < subject.table.size(); ++s) {
      const BoundarySegment& segment = subject.table[SegmentId(s)];
      EXPECT_GT(segment.floor, 0);
      EXPECT_LE(segment.floor, segment.length / 8);
      const std::vector<double> cuts = all_cuts(subject.table, SegmentId(s));
      ASSERT_GT(cuts.size(), 7u);
      EXPECT_GE(shortest_piece(cuts, segment.length), segment.floor * (1 - 1e-12));
    }
  }
}

TEST(segment_table, the_floor_follows_what_is_near) {
  // A long segment beside another one: the nearer, the lower.
  double last = HUGE_VAL;
  for (const double width : {1.0, 0.1, 0.01, 0.001}) {
    const TableSubject subject(shapes::polygon({{0, 0}, {1, 0}, {1, width}, {0, width}}));
    const double floor = subject.table[subject.between({0, 0, 0}, {1, 0, 0})].floor;
    EXPECT_LT(floor, last);
    EXPECT_LE(floor, width / 2);
    last = floor;
  }
}

TEST(segment_table, a_shortest_edge_is_a_floor) {
  const TableSubject subject(shapes::box({1, 1, 1}), goals(0.3));
  for (std::uint32_t s = 0; s < 12; ++s) {
    EXPECT_GE(subject.table[SegmentId(s)].floor, 0.3);
    EXPECT_EQ(all_cuts(subject.table, SegmentId(s)), (std::vector<double>{0.5}));
  }
  // On rings at a sharp corner, the two segments' cuts are that far from each other, too.
  const TableSubject sharp(shapes::triangle(20, 1, 1), goals(0.05));
  const double apart = 2 * std::sin(10 * std::numbers::pi / 180);
  const SegmentId side = sharp.between({0, 0, 0}, {1, 0, 0});
  for (const double ring : sharp.rings_at({0, 0, 0}, side)) EXPECT_GE(ring * apart, 0.05);
}

TEST(segment_table, sizes_divide_evenly_into_the_fewest_parts) {
  for (const auto& [length, size, parts] :
       {std::tuple(1.0, 0.1, 10), std::tuple(3.7, 0.37, 10), std::tuple(1.0, 0.3, 4), std::tuple(0.7, 0.1, 7),
        std::tuple(1.0, 1.0, 1), std::tuple(1.0, 2.0, 1), std::tuple(1.0, 0.99, 2)}) {
    const TableSubject subject(shapes::box({length, length, length}), remesh::goals_of({}, 1), size);
    for (std::uint32_t s = 0; s < 12; ++s) {
      const std::vector<double> cuts = subject.table.size_cuts(SegmentId(s), subject.sizes);
      ASSERT_EQ(cuts.size(), static_cast<std::size_t>(parts - 1)) << length << " by " << size;
      for (std::size_t i = 0; i < cuts.size(); ++i)
        EXPECT_NEAR(cuts[i], static_cast<double>(i + 1) / parts, 1e-15) << length << " by " << size;
    }
  }
}

TEST(segment_table, no_more_cuts_are_made_than_can_be_used) {
  // A million million parts could not even be listed.
  const TableSubject subject(shapes::box({1, 1, 1}), remesh::goals_of({}, 1), 1e-12);
  for (const std::uint64_t max_cuts : {0, 1, 9}) {
    const std::vector<double> cuts = subject.table.size_cuts(SegmentId(0), subject.sizes, max_cuts);
    ASSERT_EQ(cuts.size(), max_cuts);
    for (std::size_t i = 0; i < cuts.size(); ++i)
      EXPECT_NEAR(cuts[i], static_cast<double>(i + 1) / static_cast<double>(max_cuts + 1), 1e-15);
  }
}

TEST(segment_table, without_a_size_nothing_is_cut_for_it) {
  const TableSubject subject(shapes::box({1, 1, 1}));
  for (std::uint32_t s = 0; s < 12; ++s) EXPECT_TRUE(subject.table.size_cuts(SegmentId(s), subject.sizes).empty());
}

TEST(segment_table, sizes_that_grow_are_followed_along_a_segment) {
  const PolygonMesh mesh = shapes::polygon({{0, 0}, {8, 0}, {8, 8}, {0.05, 8}, {0, 7.95}});
  Options options;
  options.gradation = 1.3;
  const Goals graded = goals_of(options, 1);
  StageChain chain(mesh);
  const SizeField sizes(chain.surface, nullptr, segment_ends(chain.meshes, chain.control), graded, 1e-6, chain.control);
  SegmentTable table(chain.surface, chain.triangulated, IdVector<PatchId, std::uint8_t>(1), sizes, graded,
                     chain.control);
  table.plan_cuts(chain.triangulated, sizes, graded, chain.control);
  std::size_t cuts_in_all = 0;
  for (std::uint32_t s = 0; s < table.size(); ++s) {
    std::vector<double> cuts = table.size_cuts(SegmentId(s), sizes);
    cuts_in_all += cuts.size();
    EXPECT_TRUE(std::is_sorted(cuts.begin(), cuts.end()));
    const std::vector<double> few = table.size_cuts(SegmentId(s), sizes, 3);
    EXPECT_EQ(few.size(), std::min<std::size_t>(cuts.size(), 3));
    EXPECT_TRUE(std::is_sorted(few.begin(), few.end()));
    EXPECT_EQ(table.size_cuts(SegmentId(s), sizes, 1000), cuts);
    cuts.insert(cuts.begin(), 0);
    cuts.push_back(1);
    for (std::size_t i = 1; i < cuts.size(); ++i) {
      const double length = (cuts[i] - cuts[i - 1]) * table[SegmentId(s)].length;
      const double size = sizes.at(table.position(SegmentId(s), (cuts[i] + cuts[i - 1]) / 2));
      EXPECT_LE(length, 1.1 * size);
    }
  }
  EXPECT_GT(cuts_in_all, 10u);
}

TEST(segment_table, sizes_below_the_shortest_edge_give_way) {
  const TableSubject subject(shapes::box({1, 1, 1}), goals(0.3), 0.1);
  for (std::uint32_t s = 0; s < 12; ++s) {
    const std::vector<double> cuts = subject.table.size_cuts(SegmentId(s), subject.sizes);
    EXPECT_EQ(cuts.size(), 2u);
    EXPECT_GE(shortest_piece(cuts, 1), 0.3);
  }
}

TEST(segment_table, locked_segments_stay_as_they_are) {
  Options options;
  options.split_boundaries = false;
  const TableSubject all(shapes::box({1, 1, 1}), goals_of(options, 1), 0.1);
  for (std::uint32_t s = 0; s < 12; ++s) {
    EXPECT_TRUE(all.table[SegmentId(s)].is_locked());
    EXPECT_EQ(all.table.cut(SegmentId(s), 0, 1), std::nullopt);
    EXPECT_TRUE(all.table.size_cuts(SegmentId(s), all.sizes).empty());
  }

  TableSubject one(shapes::box({1, 1, 1}), goals(), 0.1);
  one.frozen[PatchId(2)] = 1;
  SegmentTable table = one.make(goals());
  std::size_t locked = 0;
  for (std::uint32_t s = 0; s < 12; ++s) {
    const auto sides = table.sides(SegmentId(s));
    const bool is_beside = std::any_of(sides.begin(), sides.end(), [](const auto& x) { return x.patch == PatchId(2); });
    EXPECT_EQ(table[SegmentId(s)].is_locked(), is_beside);
    locked += table[SegmentId(s)].is_locked();
  }
  EXPECT_EQ(locked, 4u);
  for (std::uint32_t s = 0; s < 12; ++s) table.lock(SegmentId(s));
  EXPECT_EQ(table.cut(SegmentId(0), 0, 1), std::nullopt);
}

TEST(even_parts, are_cut_apart_before_they_are_halved) {
  for (const double count : {1.0, 2.0, 3.0, 7.0, 10.0, 1023.0})
    for (const bool is_shifted : {false, true}) {
      const EvenParts parts{count, is_shifted};
      std::vector<double> ends{0, 1};
      for (double k = 1; k < count + (is_shifted ? 1 : 0); ++k) ends.push_back((k - (is_shifted ? 0.5 : 0)) / count);
      std::sort(ends.begin(), ends.end());
      if (count < 2) ends = {0, 1};
      const std::set<double> allowed(ends.begin(), ends.end());
      std::set<double> found{0, 1};
      std::vector<std::pair<double, double>> pieces{{0, 1}};
      while (!pieces.empty()) {
        const auto [t0, t1] = pieces.back();
        pieces.pop_back();
        const double t = parts.cut(t0, t1);
        if (allowed.count(t) == 0) {
          EXPECT_EQ(t, t0 + (t1 - t0) / 2);
          continue;
        }
        // Neither side gets much more than the other: at most three of four halves of parts.
        EXPECT_LE(std::max(t - t0, t1 - t), 0.75 * (t1 - t0) * (1 + 1e-9)) << count << (is_shifted ? " shifted" : "");
        found.insert(t);
        pieces.push_back({t0, t});
        pieces.push_back({t, t1});
      }
      EXPECT_EQ(found, allowed) << count << (is_shifted ? " shifted" : "");
    }
}

/// Returns the segments of a prism's long sides, in their order around it.
std::vector<SegmentId> long_sides(const TableSubject& subject, std::size_t sides, double height) {
  std::vector<std::pair<double, SegmentId>> found;
  for (std::uint32_t s = 0; s < subject.table.size(); ++s) {
    const BoundarySegment& segment = subject.table[SegmentId(s)];
    const Vec3 &a = subject.chain.surface.positions[segment.from], &b = subject.chain.surface.positions[segment.to];
    if (std::fabs(b.z - a.z) > height / 2) found.emplace_back(std::atan2(a.y, a.x), SegmentId(s));
  }
  std::sort(found.begin(), found.end());
  EXPECT_EQ(found.size(), sides);
  std::vector<SegmentId> ids;
  for (const auto& [angle, s] : found) ids.push_back(s);
  return ids;
}

TEST(strips, sides_have_the_fewest_parts_for_the_bound_and_take_turns) {
  for (const std::size_t sides : {16u, 17u}) {
    const double height = 10, width = 2 * std::sin(std::numbers::pi / static_cast<double>(sides));
    for (const double bound : {20.0, 25.0, 33.0}) {
      Options options;
      options.min_angle_deg = bound;
      const TableSubject subject(shapes::cylinder(static_cast<int>(sides), 1, height), goals_of(options, 1));
      const std::vector<SegmentId> ids = long_sides(subject, sides, height);
      // Triangles with two equal sides, one's top over the middle of its base, the others' beside it.
      const double angle = std::max(bound, 30.0) * std::numbers::pi / 180;
      const double fewest = std::ceil(height / (2 * width / std::tan(angle)));
      std::size_t same = 0;
      for (std::size_t k = 0; k < sides; ++k) {
        const EvenParts& parts = subject.table[ids[k]].parts;
        EXPECT_GE(parts.count, fewest);
        EXPECT_LE(parts.count, fewest + 1);
        EXPECT_EQ(parts.count, subject.table[ids[0]].parts.count);
        same += parts.is_shifted == subject.table[ids[(k + 1) % sides]].parts.is_shifted;
      }
      EXPECT_EQ(same, sides % 2) << "an odd ring has two alike side by side";
    }
  }
}

TEST(strips, a_bar_has_the_parts_of_its_narrow_sides) {
  const TableSubject subject(shapes::box({1, 3, 100}));
  const double by_narrow = subject.table[subject.between({0, 0, 0}, {0, 0, 100})].parts.count;
  EXPECT_GT(by_narrow, 25);
  for (std::uint32_t s = 0; s < 12; ++s) {
    const BoundarySegment& segment = subject.table[SegmentId(s)];
    EXPECT_EQ(segment.parts.count, segment.length > 50 ? by_narrow : 1);
  }
  const TableSubject wide(shapes::box({2, 3, 4}));
  for (std::uint32_t s = 0; s < 12; ++s) EXPECT_EQ(wide.table[SegmentId(s)].parts.count, 1);
}

TEST(strips, sizes_below_half_of_the_parts_divide_evenly) {
  const double height = 10, width = 2 * std::sin(std::numbers::pi / 16);
  for (const double size : {width, 0.3, 5.0}) {
    const TableSubject subject(shapes::cylinder(16, 1, height), goals(), size);
    const std::vector<SegmentId> ids = long_sides(subject, 16, height);
    const double half = width / std::tan(30 * std::numbers::pi / 180);
    for (const SegmentId s : ids) {
      std::vector<double> cuts = subject.table.size_cuts(s, subject.sizes);
      EXPECT_LE(longest_piece(cuts, height), size * (1 + 1e-9));
      if (size < half) {
        EXPECT_EQ(cuts.size() + 1, std::ceil(height / size * (1 - 1e-12)));
        EXPECT_GE(shortest_piece(cuts, height), height / (static_cast<double>(cuts.size()) + 1) * (1 - 1e-9));
      }
    }
  }
}

TEST(strips, sides_that_want_three_and_four_parts_have_them) {
  // Facets 1 wide, and a size of 2: sides of 5.8 and 6.2 need three and four parts, and their ends are apart by
  // themselves. Sides of 5.2 and 5.8 both need three, and take turns.
  const auto cuts_of = [](double low, double high) {
    const double in = (high - low) / 2;
    const TableSubject subject(shapes::polygon({{0, 0}, {high, 0}, {high - in, 1}, {in, 1}}), goals(), 2);
    const SegmentId longer = subject.between({0, 0, 0}, {high, 0, 0});
    const SegmentId shorter = subject.between({in, 1, 0}, {high - in, 1, 0});
    return std::pair(subject.table.size_cuts(shorter, subject.sizes), subject.table.size_cuts(longer, subject.sizes));
  };
  const auto [three, four] = cuts_of(5.8, 6.2);
  EXPECT_EQ(three.size(), 2u);
  EXPECT_EQ(four.size(), 3u);
  const auto [even, between] = cuts_of(5.2, 5.8);
  EXPECT_EQ(even.size() + between.size(), 2u + 3u);
}

TEST(strips, the_shortest_edge_goes_before_them) {
  const TableSubject subject(shapes::cylinder(16, 1, 10), goals(0.4));
  for (const SegmentId s : long_sides(subject, 16, 10)) EXPECT_GE(shortest_piece(all_cuts(subject.table, s), 10), 0.4);
}

TEST(segment_table, places_are_the_same_from_either_end) {
  const TableSubject subject(shapes::rotated(shapes::box({1, 2, 3}), {1, 2, 3}, 33));
  for (std::uint32_t s = 0; s < 12; ++s) {
    const BoundarySegment& segment = subject.table[SegmentId(s)];
    const Vec3 &from = subject.chain.surface.positions[segment.from], &to = subject.chain.surface.positions[segment.to];
    EXPECT_EQ(subject.table.position(SegmentId(s), 0), from);
    EXPECT_EQ(subject.table.position(SegmentId(s), 1), to);
    for (const double t : {0.1, 0.25, 0.5, 0.9}) {
      const Vec3 p = subject.table.position(SegmentId(s), t);
      EXPECT_NEAR(norm(p - from), t * segment.length, 1e-15 * 16);
      EXPECT_NEAR(norm(p - to), (1 - t) * segment.length, 1e-15 * 16);
    }
  }
}

STAGE(segment_table, test::kScale) {
  const TableSubject subject(trial.of(solids::needle_fan(7, 8)), remesh::goals_of({}, 1), kNoSize, 1e-6 * trial.scale);
  for (std::uint32_t s = 0; s < subject.table.size(); ++s)
    trial.in_order(trial.length(subject.table[SegmentId(s)].floor), all_cuts(subject.table, SegmentId(s)));
}

TEST(segment_ends, each_segment_is_named_once) {
  const StageChain chain(shapes::box({1, 1, 1}, 3));
  const auto ends = segment_ends(chain.meshes, chain.control);
  EXPECT_EQ(ends.size(), 12u);
  EXPECT_TRUE(std::is_sorted(ends.begin(), ends.end()));
  for (const auto& [a, b] : ends) EXPECT_LT(a, b);
}

}  // namespace
}  // namespace remesh
