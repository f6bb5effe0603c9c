#include "core/refinement/sizes/patch_contacts.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/base/stoppable.h"
#include "core/geometry/triangles/distances.h"

namespace remesh {
namespace {

/// The number of objects that were made so far. Each object has a number of its own, so that a thread never takes data
/// that it stores for one object for data of another.
std::atomic<std::uint64_t> made = 0;

}  // namespace

double way_over(const Vec3& a, const Vec3& b, const Vec3& p, const Vec3& q) {
  const double length = norm(b - a);
  if (!(length > 0)) return norm(p - a) + norm(q - a);
  const Vec3 along = (1 / length) * (b - a);
  const double s = dot(p - a, along), t = dot(q - a, along);
  const double p_off = norm((p - a) - s * along), q_off = norm((q - a) - t * along);
  const double off = p_off + q_off;
  const double crossing = std::clamp(off > 0 ? s + (t - s) * (p_off / off) : s, 0.0, length);
  return std::hypot(crossing - s, p_off) + std::hypot(crossing - t, q_off);
}

/// Stores the vertices and edges that two patches share, if there are only a few. A search for gaps asks about the same
/// few pairs of patches at place after place, and without this store each answer would walk along a whole border.
struct PatchContacts::Shared {
  /// An edge, or a vertex with a = b.
  struct Item {
    VertexId a, b;
  };
  static constexpr std::size_t kMaxItems = 4;

  std::uint64_t of = 0;  ///< the object whose patches these are; 0: none
  PatchId p, q;
  std::uint32_t count = 0;  ///< if more than kMaxItems, the items are not stored
  std::array<Item, kMaxItems> items;
};

PatchContacts::PatchContacts(const Surface& surface, const Adjacency& adjacency, const PatchSet& patches,
                             RunControl& control)
    : surface_(surface), adjacency_(adjacency), patches_(patches), number_(++made), tree_of_(patches.count(), kNoTree) {
  find_vertex_patches(control);
  find_borders(control);
  find_crowds(control);
  for (std::size_t p = 0; p < patches.count(); ++p)
    if (border(PatchId(p)).size() > kLongBorder) add_tree(PatchId(p), control);
}

void PatchContacts::find_vertex_patches(RunControl& control) {
  StopCheck check(control);
  // Visits patch after patch, so that each vertex gets its patches in ascending order. A first pass counts the patches,
  // and a second one enters them.
  const auto each = [&](const auto& visit) {
    IdVector<VertexId, PatchId> last(surface_.vertex_count());
    for (std::size_t p = 0; p < patches_.count(); ++p) {
      for (const FaceId f : patches_.faces_of(PatchId(p)))
        for (const VertexId v : surface_.face(f)) {
          check();
          if (last[v] == PatchId(p)) continue;
          last[v] = PatchId(p);
          visit(v, PatchId(p));
        }
    }
  };
  vertex_begin_.assign(surface_.vertex_count() + 1, 0);
  each([&](VertexId v, PatchId) { ++vertex_begin_[v.value + 1]; });
  for (std::size_t v = 0; v < surface_.vertex_count(); ++v) vertex_begin_[v + 1] += vertex_begin_[v];
  vertex_patches_.resize(vertex_begin_.back());
  std::vector<std::uint32_t> end(vertex_begin_.begin(), vertex_begin_.end() - 1);
  each([&](VertexId v, PatchId p) { vertex_patches_[end[v.value]++] = p; });
}

void PatchContacts::find_borders(RunControl& control) {
  IdVector<VertexId, PatchId> last(surface_.vertex_count());  // the last patch that has this vertex on its border
  border_begin_.assign(1, 0);
  StopCheck check(control);
  for (std::size_t i = 0; i < patches_.count(); ++i) {
    const PatchId p(i);
    // The half-edges of the border come first, and then the vertices inside the patch that other patches touch.
    for (const bool is_border : {true, false})
      for (const FaceId f : patches_.faces_of(p))
        for (std::uint32_t h = surface_.face_begin[f.value]; h < surface_.face_begin[f.value + 1]; ++h) {
          check();
          const VertexId v = adjacency_.from(h);
          if (patches_at(v).size() < 2) continue;
          if (is_border ? !is_patch_boundary(adjacency_, patches_, h) : last[v] == p) continue;
          last[v] = p;
          border_.push_back(h);
        }
    border_begin_.push_back(static_cast<std::uint32_t>(border_.size()));
  }
}

void PatchContacts::find_crowds(RunControl& control) {
  StopCheck check(control);
  for (std::size_t e = 0; e < adjacency_.edge_count(); ++e) {
    check();
    const auto around = adjacency_.half_edges(EdgeId(e));
    if (around.size() <= kCrowded) continue;
    Crowd& crowd = crowds_.emplace_back(Crowd{EdgeId(e), {}});
    crowd.patches.reserve(around.size());
    for (const std::uint32_t h : around) crowd.patches.push_back(patches_.of_face[adjacency_.face_of(h)]);
    sort_stoppable(crowd.patches.begin(), crowd.patches.end(), control);
  }
}

void PatchContacts::add_tree(PatchId p, RunControl& control) {
  std::vector<BoxTree<NoTag>::Entry> entries;
  entries.reserve(border(p).size());
  for (const std::uint32_t h : border(p)) {
    FloatBox box;
    box.add(surface_.local[adjacency_.from(h)]);
    box.add(surface_.local[adjacency_.to(h)]);
    entries.push_back({box, {}});
  }
  tree_of_[p] = static_cast<std::uint32_t>(trees_.size());
  trees_.emplace_back(entries, control);
}

VertexId PatchContacts::busiest_vertex(PatchId p) const {
  VertexId busiest;
  for (const std::uint32_t h : border(p)) {
    const VertexId v = adjacency_.from(h);
    const std::size_t most = busiest.is_valid() ? patches_at(busiest).size() : 0;
    if (patches_at(v).size() > most || (patches_at(v).size() == most && v < busiest)) busiest = v;
  }
  return busiest;
}

std::vector<VertexId> PatchContacts::corners(PatchId p, std::size_t least_patches, std::size_t most_patches) const {
  std::vector<VertexId> found;
  for (const std::uint32_t h : border(p)) {
    const std::size_t patches = patches_at(adjacency_.from(h)).size();
    if (patches >= least_patches && patches <= most_patches) found.push_back(adjacency_.from(h));
  }
  return found;
}

std::array<PatchId, 2> PatchContacts::largest_neighbours(PatchId p, std::size_t most_patches) const {
  std::array<PatchId, 2> largest;
  const auto is_larger = [&](PatchId q, PatchId than) {
    if (!than.is_valid() || border(q).size() != border(than).size())
      return !than.is_valid() || border(q).size() > border(than).size();
    return q < than;
  };
  for (const VertexId v : corners(p, 2, most_patches))
    for (const PatchId q : patches_at(v)) {
      if (q == p || q == largest[0] || q == largest[1]) continue;
      if (is_larger(q, largest[0])) {
        largest = {q, largest[0]};
      } else if (is_larger(q, largest[1])) {
        largest[1] = q;
      }
    }
  return largest;
}

bool PatchContacts::is_at(VertexId v, PatchId p) const {
  constexpr std::size_t kFew = 8;
  const auto all = patches_at(v);
  return all.size() <= kFew ? std::find(all.begin(), all.end(), p) != all.end()
                            : std::binary_search(all.begin(), all.end(), p);
}

bool PatchContacts::is_along(std::uint32_t half_edge, PatchId p) const {
  const EdgeId edge = adjacency_.edge_of(half_edge);
  const auto around = adjacency_.half_edges(edge);
  if (around.size() > kCrowded) {
    const auto crowd =
        std::lower_bound(crowds_.begin(), crowds_.end(), edge, [](const Crowd& c, EdgeId e) { return c.edge < e; });
    return std::binary_search(crowd->patches.begin(), crowd->patches.end(), p);
  }
  return std::any_of(around.begin(), around.end(),
                     [&](std::uint32_t h) { return patches_.of_face[adjacency_.face_of(h)] == p; });
}

bool PatchContacts::are_joined(PatchId p, PatchId q) const {
  if (border(q).size() < border(p).size()) std::swap(p, q);
  const auto corners = border(p);
  return std::any_of(corners.begin(), corners.end(), [&](std::uint32_t h) { return is_at(adjacency_.from(h), q); });
}

/// Returns the vertices and edges that the two patches share. The reference is valid until the next call in this
/// thread. The answer does not depend on earlier calls.
/// Input: The border of p is not longer than that of q.
const PatchContacts::Shared& PatchContacts::shared(PatchId p, PatchId q) const {
  constexpr std::size_t kPairs = 256;
  thread_local std::array<Shared, kPairs> known;
  Shared& of_pair = known[(p.value * 31u + q.value) % kPairs];
  if (of_pair.of == number_ && of_pair.p == p && of_pair.q == q) return of_pair;
  of_pair = {number_, p, q, 0, {}};
  for (const std::uint32_t h : border(p)) {
    const VertexId v = adjacency_.from(h);
    if (!is_at(v, q)) continue;
    if (of_pair.count++ == Shared::kMaxItems) break;
    of_pair.items[of_pair.count - 1] = {v, is_along(h, q) ? adjacency_.to(h) : v};
  }
  return of_pair;
}

template <class Bound, class IsWanted>
bool PatchContacts::any_shared(PatchId p, PatchId q, double most, const Bound& bound, const IsWanted& is_wanted) const {
  if (border(q).size() < border(p).size()) std::swap(p, q);
  const auto corners = border(p);
  if (tree_of_[p] == kNoTree) {
    const Shared& few = shared(p, q);
    if (few.count <= Shared::kMaxItems)
      return std::any_of(few.items.begin(), few.items.begin() + few.count, [&](const Shared::Item& item) {
        return is_wanted(surface_.local[item.a], surface_.local[item.b]);
      });
  }
  const auto is_wanted_at = [&](std::uint32_t h) {
    const VertexId v = adjacency_.from(h);
    if (!is_at(v, q)) return false;
    const Vec3& a = surface_.local[v];
    return is_wanted(a, is_along(h, q) ? surface_.local[adjacency_.to(h)] : a);
  };
  if (tree_of_[p] == kNoTree) return std::any_of(corners.begin(), corners.end(), is_wanted_at);
  const BoxTree<NoTag>& tree = trees_[tree_of_[p]];
  bool is_found = false;
  double best = std::nextafter(most, HUGE_VAL);
  tree.search(
      best, [&](const auto& entry) { return bound(entry.box); },
      [&](std::size_t slot) {
        is_found = is_found || is_wanted_at(corners[tree.number(slot)]);
        if (is_found) best = -1;
      });
  return is_found;
}

bool PatchContacts::are_joined_within(PatchId p, PatchId q, const Vec3& place, double distance) const {
  const double squared = distance * distance;
  return any_shared(
      p, q, squared, [&](const FloatBox& box) { return squared_distance(box, place); },
      [&](const Vec3& a, const Vec3& b) { return norm_squared(nearest_on_segment(place, a, b) - place) <= squared; });
}

bool PatchContacts::has_way(PatchId p, const Vec3& from, PatchId q, const Vec3& to, double most) const {
  return any_shared(
      p, q, most,
      [&](const FloatBox& box) {
        return std::sqrt(squared_distance(box, from)) + std::sqrt(squared_distance(box, to));
      },
      [&](const Vec3& a, const Vec3& b) { return way_over(a, b, from, to) <= most; });
}

}  // namespace remesh
