#include "core/free_form/sheet_split.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace remesh {
namespace {

/// A triangle that is split in its plane may get angles down to the one with this cosine.
constexpr double kFlat = 0.9998;

}  // namespace

bool SheetSplitter::move_to_input(std::span<const FaceId> faces) {
  std::vector<VertexId> vertices;
  for (const FaceId f : faces)
    vertices.insert(vertices.end(), free_.sheet.faces[f].begin(), free_.sheet.faces[f].end());
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  bool is_any_moved = false;
  for (const VertexId v : vertices) {
    control_.check();
    if (move_to_input(v)) is_any_moved = true;
  }
  return is_any_moved;
}

std::vector<VertexId> SheetSplitter::split(std::span<const FaceId> faces, Place place) {
  const Sheet& sheet = free_.sheet;
  std::vector<Triangle> before;
  before.reserve(faces.size());
  for (const FaceId f : faces) before.push_back(sheet.faces[f]);
  std::vector<VertexId> touched;
  for (std::size_t i = 0; i < faces.size(); ++i) {
    control_.check();
    const FaceId f = faces[i];
    // A neighbour may have split it.
    if (sheet.faces[f] == before[i]) {
      std::array<std::uint32_t, 3> edges{3 * f.value, 3 * f.value + 1, 3 * f.value + 2};
      const auto squared_length = [&](std::uint32_t c) {
        return norm_squared(sheet.place(Sheet::after(c)) - sheet.place(c));
      };
      std::stable_sort(edges.begin(), edges.end(),
                       [&](std::uint32_t a, std::uint32_t b) { return squared_length(a) > squared_length(b); });
      std::any_of(edges.begin(), edges.end(), [&](std::uint32_t c) { return split(c, place); });
    }
    touched.insert(touched.end(), before[i].begin(), before[i].end());
    touched.insert(touched.end(), sheet.faces[f].begin(), sheet.faces[f].end());
  }
  std::sort(touched.begin(), touched.end());
  touched.erase(std::unique(touched.begin(), touched.end()), touched.end());
  return touched;
}

/// Returns a face of the input near a place at some vertices: that of the nearest witness of the faces around them, or
/// else the nearest face.
FaceId SheetSplitter::start_near(std::initializer_list<VertexId> vertices, const Vec3& place) const {
  const Sheet& sheet = free_.sheet;
  FaceId found;
  double nearest = HUGE_VAL;
  for (const VertexId v : vertices)
    sheet.for_star(v, [&](std::uint32_t c) {
      for (std::uint32_t w = free_.witnesses.of_face[Sheet::face_of(c)]; w != kNone; w = free_.witnesses.all[w].next) {
        const SheetWitnesses::Witness& witness = free_.witnesses.all[w];
        const double squared = norm_squared(witness.place - place);
        if (squared > nearest || (squared == nearest && witness.face > found)) continue;
        nearest = squared;
        found = witness.face;
      }
    });
  return found.is_valid() ? found
                          : input_.nearest_face(place, sheet.origin[Sheet::face_of(sheet.first[*vertices.begin()])]);
}

bool SheetSplitter::move_to_input(VertexId v) {
  Sheet& sheet = free_.sheet;
  if (free_.source[v].is_valid() || sheet.kind[v] != Sheet::Kind::kFree || !sheet.has_small_star(v)) return false;
  trial_.clear();
  sheet.for_star(v, [&](std::uint32_t c) {
    trial_.add_changed(Sheet::face_of(c),
                       {sheet.positions[v], sheet.place(Sheet::after(c)), sheet.place(Sheet::before(c))});
  });
  const Vec3 place = input_.near_place(sheet.positions[v], start_near({v}, sheet.positions[v]));
  if (place == sheet.positions[v] || !trial_.has_good_shapes(place, std::max(kNeedle, trial_.cosine_before())))
    return false;
  sheet.positions[v] = place;
  return true;
}

/// Returns whether all triangles at an edge may be split at a place.
bool SheetSplitter::is_split_possible(VertexId v, VertexId w, const Vec3& place, double max_cosine) {
  const Sheet& sheet = free_.sheet;
  trial_.clear();
  for (const std::uint32_t c : sheet.corners_at_edge(v, w)) {
    const Vec3 &from = sheet.place(c), &to = sheet.place(Sheet::after(c)), &across = sheet.place(Sheet::before(c));
    trial_.add_changed(Sheet::face_of(c), {place, across, from});
    trial_.add_changed(Sheet::face_of(c), {place, to, across});
  }
  // Halves of a needle have its angle at the tip.
  return trial_.has_good_shapes(place, std::max(max_cosine, (1 + trial_.cosine_before()) / 2));
}

/// Returns the witness of a chain edge that is nearest to a place; kNone if there are none.
std::uint32_t SheetSplitter::near_witness(std::uint32_t chain, const Vec3& place) const {
  const auto& all = free_.witnesses.on_chains;
  std::uint32_t found = kNone;
  double nearest = HUGE_VAL;
  for (std::uint32_t i = free_.witnesses.of_chain[chain]; i != kNone; i = all[i].next) {
    const double squared = norm_squared(all[i].place - place);
    if (squared > nearest || (squared == nearest && all[i].vertex > all[found].vertex)) continue;
    nearest = squared;
    found = i;
  }
  return found;
}

/// Divides the witnesses of a chain edge from v to w at one of them, which then belongs to neither half.
/// Input: `far_chain` is the number of the half at w.
void SheetSplitter::divide_chain(std::uint32_t chain, std::uint32_t middle, VertexId v, VertexId w,
                                 std::uint32_t far_chain) {
  SheetWitnesses& witnesses = free_.witnesses;
  const Vec3 way = free_.sheet.positions[w] - free_.sheet.positions[v];
  const double half = dot(witnesses.on_chains[middle].place, way);
  std::uint32_t i = std::exchange(witnesses.of_chain[chain], kNone);
  while (i != kNone) {
    SheetWitnesses::ChainWitness& witness = witnesses.on_chains[i];
    const std::uint32_t following = witness.next;
    if (i != middle) {
      std::uint32_t& first = witnesses.of_chain[dot(witness.place, way) < half ? chain : far_chain];
      witness.next = std::exchange(first, i);
    }
    i = following;
  }
}

/// Gives the witnesses of some faces to the nearest of those that are in their place.
void SheetSplitter::share_witnesses(std::span<const FaceId> old_faces, std::span<const FaceId> faces) {
  SheetWitnesses& witnesses = free_.witnesses;
  std::vector<std::uint32_t> all;
  for (const FaceId f : old_faces) {
    for (std::uint32_t w = witnesses.of_face[f]; w != kNone; w = witnesses.all[w].next) all.push_back(w);
    witnesses.of_face[f] = kNone;
  }
  for (const std::uint32_t w : all) {
    FaceId best = faces.front();
    double nearest = HUGE_VAL;
    const Vec3& p = witnesses.all[w].place;
    for (const FaceId f : faces) {
      const double squared = norm_squared(nearest_on_triangle(p, free_.sheet.corners_of(f)) - p);
      if (squared >= nearest) continue;
      nearest = squared;
      best = f;
    }
    witnesses.all[w].next = witnesses.of_face[best];
    witnesses.of_face[best] = w;
  }
}

bool SheetSplitter::split(std::uint32_t corner, Place wanted) {
  Sheet& sheet = free_.sheet;
  SheetWitnesses& witnesses = free_.witnesses;
  const VertexId v = sheet.vertex(corner), w = sheet.vertex(Sheet::after(corner));
  if (!sheet.has_small_star(v) || !sheet.has_small_star(w)) return false;
  std::vector<FaceId> faces;
  for (const std::uint32_t c : sheet.corners_at_edge(v, w)) faces.push_back(Sheet::face_of(c));
  const Vec3 middle = 0.5 * (sheet.positions[v] + sheet.positions[w]);
  const std::uint32_t chain = sheet.chain[corner];
  const std::uint32_t witness = chain == kNone ? kNone : near_witness(chain, middle);
  Vec3 place = middle;
  if (witness != kNone) {
    place = witnesses.on_chains[witness].place;
  } else if (chain == kNone && wanted == Place::kInput) {
    place = input_.near_place(middle, start_near({v, w}, middle));
    if (!is_split_possible(v, w, place, kNeedle)) place = middle;
  } else if (chain != kNone &&
             std::any_of(faces.begin(), faces.end(), [&](FaceId f) { return sheet.is_of_plane[f] != 0; })) {
    return false;  // an edge of the input: its middle would not be in the plane
  }
  if (!is_split_possible(v, w, place, kFlat)) return false;

  std::uint32_t far_chain = kNone;
  if (chain != kNone) {
    far_chain = static_cast<std::uint32_t>(witnesses.of_chain.size());
    witnesses.of_chain.push_back(kNone);
    sheet.is_at_plane.push_back(sheet.is_at_plane[chain]);
    if (witness != kNone) divide_chain(chain, witness, v, w, far_chain);
  }
  sheet.split(v, w, place, far_chain);
  sheet.kind.push_back(chain == kNone     ? Sheet::Kind::kFree
                       : witness == kNone ? Sheet::Kind::kFixed
                                          : Sheet::Kind::kChain);
  // Without planes, only the length of an edge counts when the new vertex is joined with a neighbour.
  free_.quadrics.push_back({});
  free_.source.push_back(witness == kNone ? VertexId() : witnesses.on_chains[witness].vertex);
  witnesses.of_vertex.push_back(witness);
  witnesses.of_face.resize(sheet.faces.size(), kNone);
  std::vector<FaceId> now = faces;
  for (std::size_t i = sheet.faces.size() - faces.size(); i < sheet.faces.size(); ++i) now.push_back(FaceId(i));
  share_witnesses(faces, now);
  return true;
}

}  // namespace remesh
