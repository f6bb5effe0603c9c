#include "core/free_form/sheet_operators.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace remesh {
namespace {

/// A place whose mean squared distance from the planes around is above this many squared tolerances is not tried.
constexpr double kHopeless = 40;
/// The weight of an edge's length in its cost. Flat places become even by it.
constexpr double kLengthWeight = 0.02;
/// The share of the tolerance that samples may use.
constexpr double kSampleShare = 0.98;

/// Returns the cosine that the smallest angle around a flip or a move may have afterwards. The angle has to become
/// larger by something that pays; a small angle by a tenth.
double cosine_wanted(double before) {
  constexpr double kGain = 0.005, kGainOfNeedles = 1.2;
  return std::max(before - kGain, 1 - kGainOfNeedles * (1 - before));
}

}  // namespace

SheetPart::SheetPart(FreeSheet& free, const InputSurface& input, const SheetRules& rules, VertexId begin, VertexId end,
                     std::vector<std::uint32_t>& tried, IdVector<VertexId, std::uint32_t>& changed,
                     const RunControl& control)
    : free_(free),
      rules_(rules),
      begin_(begin),
      end_(end),
      trial_(free.sheet, free.witnesses, input, control),
      tried_(tried),
      changed_(changed),
      control_(control) {}

bool SheetPart::is_inside(FaceId f) const {
  const Triangle& t = free_.sheet.faces[f];
  return is_inside(t[0]) && is_inside(t[1]) && is_inside(t[2]);
}

bool SheetPart::is_movable(VertexId v) const {
  const Sheet& sheet = free_.sheet;
  if (sheet.kind[v] == Sheet::Kind::kFixed || !is_inside(v) || !sheet.has_small_star(v)) return false;
  for (std::uint32_t c = sheet.first[v]; c != kNone; c = sheet.next[c])
    if (!is_inside(Sheet::face_of(c))) return false;
  return true;
}

double SheetPart::cost(const Quadric& quadric, const Vec3& place, VertexId a, VertexId b) const {
  const Sheet& sheet = free_.sheet;
  const double weight = quadric.weight();
  const double error = weight > 0 ? std::max(0.0, quadric.at(place)) / weight : 0;
  const double length = norm_squared(sheet.positions[b] - sheet.positions[a]);
  return error / (rules_.tolerance * rules_.tolerance) + kLengthWeight * length / (rules_.tolerance * rules_.diagonal);
}

Vec3 SheetPart::joint_place(VertexId a, VertexId b) const {
  Quadric sum = free_.quadrics[a];
  sum.add(free_.quadrics[b]);
  return sum.optimum(0.5 * (free_.sheet.positions[a] + free_.sheet.positions[b]));
}

std::vector<SheetPart::Candidate> SheetPart::find_candidates(const std::vector<VertexId>& vertices,
                                                             bool are_at_planes) {
  const Sheet& sheet = free_.sheet;
  std::vector<Candidate> candidates;
  for (const VertexId v : vertices) {
    if (v.value % 1024 == 0) control_.check_and_move();
    sheet.for_star(v, [&](std::uint32_t c) {
      if (sheet.is_border_of_plane(c) != are_at_planes) return;
      const VertexId w = sheet.vertex(Sheet::after(c));
      if (!is_inside(w) || (w < v && sheet.chain[c] == kNone)) return;
      if (tried_[c] > std::max(changed_[v], changed_[w])) return;
      const bool is_free = sheet.kind[v] == Sheet::Kind::kFree && sheet.kind[w] == Sheet::Kind::kFree;
      if (!is_free && sheet.chain[c] == kNone && sheet.kind[v] != Sheet::Kind::kFree &&
          sheet.kind[w] != Sheet::Kind::kFree)
        return;
      Quadric sum = free_.quadrics[v];
      sum.add(free_.quadrics[w]);
      const Vec3 &p = sheet.positions[v], &q = sheet.positions[w];
      const Vec3 place = is_free ? sum.optimum(0.5 * (p + q)) : sum.at(p) < sum.at(q) ? p : q;
      const double price = cost(sum, place, v, w);
      if (price <= kHopeless) candidates.push_back({price, c});
    });
  }
  std::sort(candidates.begin(), candidates.end());
  return candidates;
}

void SheetPart::record_change(VertexId v) {
  ++clock_;
  const Sheet& sheet = free_.sheet;
  changed_[v] = clock_;
  sheet.for_star(v, [&](std::uint32_t c) {
    for (const VertexId w : {sheet.vertex(Sheet::after(c)), sheet.vertex(Sheet::before(c))})
      if (is_inside(w)) changed_[w] = clock_;
  });
}

void SheetPart::join_vertices() {
  std::vector<VertexId> vertices;
  vertices.reserve(end_.value - begin_.value);
  for (VertexId v = begin_; v < end_; ++v.value) vertices.push_back(v);
  join(vertices, false);
}

void SheetPart::join_at_planes() {
  const Sheet& sheet = free_.sheet;
  std::vector<VertexId> vertices;
  for (VertexId v = begin_; v < end_; ++v.value)
    for (std::uint32_t c = sheet.first[v]; c != kNone; c = sheet.next[c])
      if (sheet.is_of_plane[Sheet::face_of(c)] != 0) {
        vertices.push_back(v);
        break;
      }
  join(vertices, true);
}

void SheetPart::join(const std::vector<VertexId>& vertices, bool are_at_planes) {
  constexpr double kFewMore = 0.0025;
  IdVector<VertexId, std::uint8_t> is_touched;
  for (;;) {
    const std::vector<Candidate> candidates = find_candidates(vertices, are_at_planes);
    const std::uint64_t before = joined_;
    is_touched.assign(end_.value - begin_.value, 0);
    const auto touched = [&](VertexId v) -> std::uint8_t& { return is_touched[VertexId(v.value - begin_.value)]; };
    for (const Candidate& candidate : candidates) {
      control_.check();
      if (!is_work_left()) return;
      const Sheet& sheet = free_.sheet;
      if (!sheet.is_alive(Sheet::face_of(candidate.corner))) continue;
      const VertexId v = sheet.vertex(candidate.corner), w = sheet.vertex(Sheet::after(candidate.corner));
      if (touched(v) != 0 || touched(w) != 0) continue;
      if (try_join(candidate.corner)) {
        touched(v) = touched(w) = 1;
        ++joined_;
      } else {
        tried_[candidate.corner] = ++clock_;
      }
    }
    if (static_cast<double>(joined_ - before) <= kFewMore * static_cast<double>(vertices.size())) return;
  }
}

bool SheetPart::try_join(std::uint32_t corner) {
  const Sheet& sheet = free_.sheet;
  const VertexId a = sheet.vertex(corner), b = sheet.vertex(Sheet::after(corner));
  const bool is_a_movable = is_movable(a), is_b_movable = is_movable(b);
  if (sheet.chain[corner] != kNone)
    return (is_a_movable && try_join_on_chain(a, b)) || (is_b_movable && try_join_on_chain(b, a));
  const bool is_a_free = is_a_movable && sheet.kind[a] == Sheet::Kind::kFree;
  const bool is_b_free = is_b_movable && sheet.kind[b] == Sheet::Kind::kFree;
  if (is_a_free && is_b_free) return try_join_free(a, b);
  return (is_a_free && try_join_to(a, b)) || (is_b_free && try_join_to(b, a));
}

/// Adds the triangles around a vertex, which stay unless they have the other vertex as well.
void SheetPart::add_star(VertexId v, VertexId other, bool is_other_in) {
  const Sheet& sheet = free_.sheet;
  sheet.for_star(v, [&](std::uint32_t c) {
    const std::uint32_t ahead = Sheet::after(c), back = Sheet::before(c);
    if (sheet.vertex(ahead) == other || sheet.vertex(back) == other) {
      if (!is_other_in) trial_.add_removed(Sheet::face_of(c));
    } else {
      trial_.add_changed(Sheet::face_of(c), {sheet.positions[v], sheet.place(ahead), sheet.place(back)});
    }
  });
}

/// Tests a trial. If the witnesses ask for it, the apex moves across the surface.
bool SheetPart::is_acceptable(Vec3& place, double max_cosine) {
  const double tolerance = kSampleShare * rules_.tolerance;
  if (!trial_.has_good_shapes(place, max_cosine)) return false;
  if (!trial_.finds_witnesses(tolerance)) {
    if (!trial_.has_better_step()) return false;
    place += trial_.better_step() * trial_.direction();
    if (!trial_.has_good_shapes(place, max_cosine) || !trial_.finds_witnesses(tolerance)) return false;
  }
  return trial_.is_near_input(tolerance);
}

bool SheetPart::try_join_free(VertexId from, VertexId to) {
  if (!free_.sheet.can_join(from, to)) return false;
  trial_.clear();
  add_star(from, to, false);
  add_star(to, from, true);
  Vec3 place = joint_place(from, to);
  if (!is_acceptable(place, std::max(rules_.max_cosine, trial_.cosine_before()))) return false;
  commit_join(from, to, place);
  return true;
}

bool SheetPart::try_join_to(VertexId from, VertexId to) {
  if (!free_.sheet.can_join(from, to)) return false;
  trial_.clear();
  add_star(from, to, false);
  const Vec3 place = free_.sheet.positions[to];
  if (!trial_.has_good_shapes(place, std::max(rules_.max_cosine, trial_.cosine_before())) ||
      !trial_.finds_witnesses(kSampleShare * rules_.tolerance) ||
      !trial_.is_near_input(kSampleShare * rules_.tolerance))
    return false;
  commit_join(from, to, place);
  return true;
}

void SheetPart::commit_join(VertexId from, VertexId to, const Vec3& place) {
  trial_.move_witnesses(free_.witnesses);
  free_.quadrics[to].add(free_.quadrics[from]);
  if (place != free_.sheet.positions[to]) free_.source[to] = VertexId();
  free_.sheet.positions[to] = place;
  free_.sheet.join(from, to);
  record_change(to);
}

/// Returns whether the points that stand for the input's chain (its witnesses) are within the tolerance of the edge
/// from `to` to `far`, which is to replace the two edges of the chain at `from`.
bool SheetPart::are_chain_witnesses_near(VertexId from, VertexId to, VertexId far) const {
  const Sheet& sheet = free_.sheet;
  const SheetWitnesses& witnesses = free_.witnesses;
  const Vec3 &a = sheet.positions[to], &b = sheet.positions[far];
  const auto is_near = [&](std::uint32_t w) {
    const SheetWitnesses::ChainWitness& witness = witnesses.on_chains[w];
    const double near = kSampleShare * rules_.tolerance * static_cast<double>(witness.share);
    return norm_squared(nearest_on_segment(witness.place, a, b) - witness.place) <= near * near;
  };
  if (!is_near(witnesses.of_vertex[from])) return false;
  bool are_near = true;
  sheet.for_star(from, [&](std::uint32_t c) {
    for (const std::uint32_t h : {c, Sheet::before(c)})
      if (sheet.chain[h] != kNone)
        for (std::uint32_t w = witnesses.of_chain[sheet.chain[h]]; w != kNone && are_near;
             w = witnesses.on_chains[w].next)
          are_near = is_near(w);
  });
  return are_near;
}

bool SheetPart::try_join_on_chain(VertexId from, VertexId to) {
  Sheet& sheet = free_.sheet;
  if (sheet.kind[from] != Sheet::Kind::kChain) return false;
  VertexId far;
  std::uint32_t near_chain = kNone, far_chain = kNone;
  sheet.for_star(from, [&](std::uint32_t c) {
    const auto take = [&](std::uint32_t h, VertexId other) {
      if (sheet.chain[h] == kNone) return;
      if (other == to) {
        near_chain = sheet.chain[h];
      } else {
        far = other;
        far_chain = sheet.chain[h];
      }
    };
    take(c, sheet.vertex(Sheet::after(c)));
    take(Sheet::before(c), sheet.vertex(Sheet::before(c)));
  });
  if (!far.is_valid() || near_chain == kNone || !are_chain_witnesses_near(from, to, far)) return false;
  if (!try_join_to(from, to)) return false;
  // The witnesses of the edge that has disappeared, and the vertex itself, go over to the edge that is left.
  SheetWitnesses& witnesses = free_.witnesses;
  const auto take_over = [&](std::uint32_t w) {
    witnesses.on_chains[w].next = witnesses.of_chain[far_chain];
    witnesses.of_chain[far_chain] = w;
  };
  take_over(witnesses.of_vertex[from]);
  for (std::uint32_t w = witnesses.of_chain[near_chain]; w != kNone;) {
    const std::uint32_t following = witnesses.on_chains[w].next;
    take_over(w);
    w = following;
  }
  witnesses.of_chain[near_chain] = kNone;
  return true;
}

bool SheetPart::try_flip(std::uint32_t corner) {
  Sheet& sheet = free_.sheet;
  if (sheet.chain[corner] != kNone || sheet.is_of_plane[Sheet::face_of(corner)] != 0) return false;
  const VertexId a = sheet.vertex(corner), b = sheet.vertex(Sheet::after(corner));
  if (!sheet.has_small_star(a) || !sheet.has_small_star(b)) return false;
  const std::uint32_t other = sheet.corner_at_edge(b, a);
  if (other == kNone || !is_inside(Sheet::face_of(corner)) || !is_inside(Sheet::face_of(other))) return false;
  const VertexId c = sheet.vertex(Sheet::before(corner)), d = sheet.vertex(Sheet::before(other));
  if (c == d || !sheet.has_small_star(c) || !sheet.has_small_star(d) || sheet.are_joined(c, d)) return false;
  const Vec3 &p = sheet.positions[a], &q = sheet.positions[b], &r = sheet.positions[c], &s = sheet.positions[d];
  // Where a needle of the input is turned over, each new triangle may look to the side of an old one, and yet be folded
  // onto the other.
  if (!(dot(cross(p - r, s - r), cross(s - r, q - r)) > 0)) return false;
  trial_.clear();
  trial_.add_changed(Sheet::face_of(corner), {r, p, s});
  trial_.add_changed(Sheet::face_of(other), {r, s, q});
  if (!trial_.has_good_shapes(r, cosine_wanted(trial_.cosine_before())) ||
      !trial_.finds_witnesses(kSampleShare * rules_.tolerance) ||
      !trial_.is_near_input(kSampleShare * rules_.tolerance))
    return false;
  trial_.move_witnesses(free_.witnesses);
  sheet.flip(corner, other);
  record_change(c);
  record_change(d);
  return true;
}

bool SheetPart::try_move(VertexId v) {
  constexpr std::size_t kPlacesAround = 8;
  Sheet& sheet = free_.sheet;
  Vec3 sum, normal;
  double weight = 0, reach = 0;
  trial_.clear();
  add_star(v, VertexId(), false);
  const Vec3 here = sheet.positions[v];
  sheet.for_star(v, [&](std::uint32_t c) {
    const Vec3 &p = sheet.place(Sheet::after(c)), &q = sheet.place(Sheet::before(c));
    const Vec3 area = cross(p - here, q - here);
    normal += area;
    sum += norm(area) * ((1.0 / 3) * (here + p + q) - here);
    weight += norm(area);
    reach = std::max(reach, norm(p - here));
  });
  if (!(weight > 0)) return false;
  normal = normalized(normal);
  const double wanted = cosine_wanted(trial_.cosine_before());
  const auto is_moved = [&](const Vec3& way) {
    const Vec3 flat = way - dot(way, normal) * normal;
    Vec3 place = here + flat;
    if (!is_acceptable(place, wanted)) return false;
    trial_.move_witnesses(free_.witnesses);
    free_.source[v] = VertexId();
    sheet.positions[v] = place;
    record_change(v);
    return true;
  };
  const Vec3 centre = (1 / weight) * sum;
  if (is_moved(centre) || is_moved(0.5 * centre)) return true;
  const Vec3 east = unit_across(normal), north = cross(normal, east);
  for (const double share : {0.2, 0.08})
    for (std::size_t i = 0; i < kPlacesAround; ++i) {
      const double angle = 2 * 3.14159265358979323846 * static_cast<double>(i) / kPlacesAround;
      if (is_moved(share * reach * (std::cos(angle) * east + std::sin(angle) * north))) return true;
    }
  return false;
}

void SheetPart::improve_angles() {
  for (VertexId v = begin_; v < end_; ++v.value) improve_angles_at(v);
}

void SheetPart::improve_angles(std::span<const VertexId> vertices) {
  for (const VertexId v : vertices) improve_angles_at(v);
}

void SheetPart::improve_angles_at(VertexId v) {
  const Sheet& sheet = free_.sheet;
  control_.check();
  if (!is_work_left() || !sheet.is_alive(v)) return;
  // Angles above this are left alone.
  const double good = rules_.max_cosine - 0.1;
  std::array<std::uint32_t, 32> corners;
  std::size_t count = 0;
  double worst = -1;
  sheet.for_star(v, [&](std::uint32_t c) {
    if (count < corners.size()) corners[count++] = c;
    worst = std::max(worst, max_cosine({sheet.place(c), sheet.place(Sheet::after(c)), sheet.place(Sheet::before(c))}));
  });
  if (worst < good) return;
  for (std::size_t i = 0; i < count; ++i)
    if (sheet.vertex(corners[i]) == v && v < sheet.vertex(Sheet::after(corners[i]))) try_flip(corners[i]);
  if (sheet.kind[v] == Sheet::Kind::kFree && is_movable(v)) try_move(v);
}

}  // namespace remesh
