#include "core/geometry/shells/shells.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/union_find.h"
#include "core/geometry/shells/faces_around_edge.h"

namespace remesh {
namespace {

/// The smallest volume of a solid, relative to its area times its extent. The volume of a doubled sheet is only
/// rounding.
constexpr double kNoVolume = 1e-12;

/// The number of half-edges that are visited between two checks for cancellation.
constexpr std::size_t kLooksBetweenChecks = 4096;

class ShellSearch {
 public:
  ShellSearch(std::span<const Vec3> positions, std::span<const VertexId> corners, const Adjacency& edges,
              const BodyLabels& labels, RunControl& control)
      : positions_(positions), corners_(corners), edges_(edges), labels_(labels), control_(control) {}

  Shells run() {
    UnionFind sets = connected();
    number(sets);
    find_open_ones();
    if (join_open_ones(sets)) {
      number(sets);
      find_open_ones();
    }
    find_open_neighbours();
    add_volumes();
    const auto closed =
        std::count_if(shells_.all.begin(), shells_.all.end(), [](const Shell& s) { return s.is_closed; });
    const bool has_negative =
        std::any_of(shells_.all.begin(), shells_.all.end(), [](const Shell& s) { return s.is_closed && s.volume < 0; });
    if (closed > 1 || has_negative) measure();
    return std::move(shells_);
  }

 private:
  std::size_t face_count() const { return corners_.size() / 3; }
  Vec3 corner(std::size_t f, std::size_t i) const { return positions_[corners_[3 * f + i].value]; }
  bool is_point(EdgeId e) const { return edges_.from(edges_.half_edges(e)[0]) == edges_.to(edges_.half_edges(e)[0]); }

  UnionFind connected() const {
    UnionFind sets(face_count());
    const auto join = [&](std::uint32_t h, std::uint32_t g) {
      sets.join(edges_.face_of(h).value, edges_.face_of(g).value);
    };
    for_blocks(edges_.edge_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t e = begin; e < end; ++e) {
        const auto around = edges_.half_edges(EdgeId(e));
        if (around.size() == 2) join(around[0], around[1]);
      }
    });
    if (!labels_.are_alike()) join_by_labels(join);
    return sets;
  }

  template <class Join>
  void join_by_labels(const Join& join) const {
    std::vector<std::pair<std::uint32_t, std::uint32_t>> by_label;
    for_odd_edges([&](std::span<const std::uint32_t> around) {
      if (around.size() <= 2) return;
      by_label.clear();
      for (const std::uint32_t h : around) by_label.push_back({labels_.set_of[edges_.face_of(h).value], h});
      std::sort(by_label.begin(), by_label.end());
      for (std::size_t i = 0; i < by_label.size();) {
        std::size_t end = i + 1;
        while (end < by_label.size() && by_label[end].first == by_label[i].first) ++end;
        const std::uint32_t h = by_label[i].second, g = by_label[end - 1].second;
        if (end - i == 2 && edges_.from(h) == edges_.to(g)) join(h, g);
        i = end;
      }
    });
  }

  void number(UnionFind& sets) {
    for_blocks(face_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (std::size_t f = begin; f < end; ++f) sets.flatten(static_cast<std::uint32_t>(f));
    });
    const auto firsts = select_ids<FaceId>(face_count(), kItemsPerBlock, control_, [&](std::size_t f) {
      return sets.root_of(static_cast<std::uint32_t>(f)) == f;
    });
    shells_.of_face.resize(face_count());
    shells_.all.assign(firsts.size(), {});
    for (std::size_t s = 0; s < firsts.size(); ++s) {
      shells_.all[s].first = firsts[s];
      shells_.of_face[firsts[s].value] = static_cast<std::uint32_t>(s);
    }
    for_blocks(face_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
      for (auto f = static_cast<std::uint32_t>(begin); f < end; ++f)
        if (const std::uint32_t first = sets.root_of(f); first != f) shells_.of_face[f] = shells_.of_face[first];
    });
  }

  /// Calls visit(around) with the half-edges of each edge, except edges with just two faces in opposite directions.
  template <class Visit>
  void for_odd_edges(const Visit& visit) const {
    std::size_t looks = 0;
    for (const EdgeId e : edges_.odd_edges()) {
      if (looks++ % kLooksBetweenChecks == 0) control_.check_and_move();
      const auto around = edges_.half_edges(e);
      if (!is_point(e)) visit(around);
      looks += around.size();
    }
  }

  std::uint32_t shell_of(std::uint32_t half_edge) const { return shells_.of_face[edges_.face_of(half_edge).value]; }

  void find_open_ones() {
    // The number of each shell's faces that run along the edge in the direction of its first half-edge, minus the
    // number of those that run back.
    std::vector<std::pair<std::uint32_t, int>> runs;
    for_odd_edges([&](std::span<const std::uint32_t> around) {
      runs.clear();
      for (const std::uint32_t h : around)
        runs.push_back({shell_of(h), edges_.from(h) == edges_.from(around[0]) ? 1 : -1});
      std::sort(runs.begin(), runs.end());
      for (std::size_t i = 0; i < runs.size();) {
        const std::uint32_t shell = runs[i].first;
        int sum = 0;
        for (; i < runs.size() && runs[i].first == shell; ++i) sum += runs[i].second;
        if (sum != 0) shells_.all[shell].is_closed = false;
      }
    });
  }

  bool is_open(std::uint32_t half_edge) const { return !shells_.all[shell_of(half_edge)].is_closed; }

  /// Joins shells that are not closed where they have solid between them. Output: whether any were joined.
  bool join_open_ones(UnionFind& sets) const {
    bool is_any_joined = false;
    std::vector<FaceAtEdge> faces;
    for_odd_edges([&](std::span<const std::uint32_t> around) {
      if (around.size() <= 2) return;
      const VertexId from = edges_.from(around[0]), to = edges_.to(around[0]);
      faces.clear();
      for (const std::uint32_t h : around)
        if (is_open(h))
          faces.push_back({positions_[edges_.to(edges_.next(h)).value], edges_.from(h) == from, shell_of(h), h});
      for (const auto& [h, g] : pair_faces_around_edge(positions_[from.value], positions_[to.value], faces, control_))
        is_any_joined |= sets.join(edges_.face_of(h).value, edges_.face_of(g).value);
    });
    return is_any_joined;
  }

  void find_open_neighbours() {
    for_odd_edges([&](std::span<const std::uint32_t> around) {
      if (std::none_of(around.begin(), around.end(), [&](std::uint32_t h) { return is_open(h); })) return;
      for (const std::uint32_t h : around) shells_.all[shell_of(h)].has_open_neighbours |= !is_open(h);
    });
  }

  Vec3 twice_area(std::size_t f) const { return cross(corner(f, 1) - corner(f, 0), corner(f, 2) - corner(f, 0)); }

  /// Sums over the faces of closed shells. `add(part, f)` adds face f to a partial sum, and `take(shell, part)` adds a
  /// partial sum to its shell. The partial sums depend only on the order of the faces.
  template <class Part, class Add, class Take>
  void sum_up(const Add& add, const Take& take) {
    using Parts = std::vector<std::pair<std::uint32_t, Part>>;
    for (const Parts& parts :
         map_blocks<Parts>(face_count(), kItemsPerBlock, control_, [&](std::size_t begin, std::size_t end) {
           Parts of_block;
           for (std::size_t f = begin; f < end; ++f) {
             const std::uint32_t shell = shells_.of_face[f];
             if (!shells_.all[shell].is_closed) continue;
             if (of_block.empty() || of_block.back().first != shell) of_block.push_back({shell, Part{}});
             add(of_block.back().second, f);
           }
           return of_block;
         }))
      for (const auto& [shell, part] : parts) take(shells_.all[shell], part);
  }

  void add_volumes() {
    // The tetrahedra are those between the faces and a point of their shell. With a point far away, the volume would be
    // lost in rounding errors.
    sum_up<double>(
        [&](double& volume, std::size_t f) {
          const Vec3 from = corner(shells_.all[shells_.of_face[f]].first.value, 0);
          volume += dot(corner(f, 0) - from, twice_area(f)) / 6;
        },
        [](Shell& shell, double volume) { shell.volume += volume; });
  }

  void measure() {
    struct Measures {
      double area = 0;
      Box3 box;
    };
    sum_up<Measures>(
        [&](Measures& part, std::size_t f) {
          part.area += norm(twice_area(f)) / 2;
          for (std::size_t i = 0; i < 3; ++i) part.box.add(corner(f, i));
        },
        [](Shell& shell, const Measures& part) {
          shell.area += part.area;
          shell.box.add(part.box);
        });
  }

  std::span<const Vec3> positions_;
  std::span<const VertexId> corners_;
  const Adjacency& edges_;
  const BodyLabels& labels_;
  RunControl& control_;
  Shells shells_;
};

}  // namespace

bool Shell::is_solid() const { return is_closed && std::fabs(volume) > kNoVolume * area * box.diagonal(); }

Shells find_shells(std::span<const Vec3> positions, std::span<const VertexId> corners, const Adjacency& edges,
                   const BodyLabels& labels, RunControl& control) {
  return ShellSearch(positions, corners, edges, labels, control).run();
}

}  // namespace remesh
