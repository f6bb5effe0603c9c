#include "core/free_form/sheet.h"

#include <algorithm>
#include <array>

#include "core/base/stoppable.h"

namespace remesh {

void Sheet::link(RunControl& control) {
  first.assign(positions.size(), kNone);
  next.assign(3 * faces.size(), kNone);
  StopCheck check(control);
  for (std::size_t c = next.size(); c-- > 0;) {
    check();
    if (is_alive(FaceId(c / 3))) push(vertex(static_cast<std::uint32_t>(c)), static_cast<std::uint32_t>(c));
  }
}

void Sheet::push(VertexId v, std::uint32_t corner) {
  next[corner] = first[v];
  first[v] = corner;
}

void Sheet::unlink(std::uint32_t corner) {
  std::uint32_t* at = &first[vertex(corner)];
  while (*at != corner) at = &next[*at];
  *at = next[corner];
}

void Sheet::set_chain(VertexId a, VertexId b, std::uint32_t number) {
  for_star(a, [&](std::uint32_t c) {
    if (vertex(after(c)) == b) chain[c] = number;
    if (vertex(before(c)) == b) chain[before(c)] = number;
  });
}

void Sheet::join(VertexId from, VertexId to) {
  struct Merged {
    VertexId with;
    std::uint32_t chain;
  };
  std::vector<Merged> merged;
  std::uint32_t c = first[from];
  while (c != kNone) {
    const std::uint32_t following = next[c];
    const FaceId f = face_of(c);
    const std::uint32_t ahead = after(c), back = before(c);
    const bool is_ahead = vertex(ahead) == to;
    if (is_ahead || vertex(back) == to) {
      // The two other sides of the face become one edge.
      const std::uint32_t third = is_ahead ? back : ahead;
      merged.push_back({vertex(third), std::min(chain[ahead], chain[is_ahead ? back : c])});
      unlink(ahead);
      unlink(back);
      faces[f] = {};
    } else {
      faces[f][c % 3] = to;
      push(to, c);
    }
    c = following;
  }
  first[from] = kNone;
  for (const Merged& m : merged)
    if (m.chain != kNone) set_chain(to, m.with, m.chain);
}

void Sheet::flip(std::uint32_t one, std::uint32_t other) {
  // one: a -> b in (a, b, c); other: b -> a in (b, a, d). They become (a, d, c) and (b, c, d).
  const std::uint32_t b_of_one = after(one), a_of_other = after(other);
  const VertexId c = vertex(before(one)), d = vertex(before(other));
  unlink(b_of_one);
  unlink(a_of_other);
  faces[face_of(one)][b_of_one % 3] = d;
  faces[face_of(other)][a_of_other % 3] = c;
  push(d, b_of_one);
  push(c, a_of_other);
  const std::uint32_t of_bc = chain[b_of_one], of_ad = chain[a_of_other];
  chain[one] = of_ad;
  chain[b_of_one] = kNone;
  chain[other] = of_bc;
  chain[a_of_other] = kNone;
}

void Sheet::split(VertexId v, VertexId w, const Vec3& place, std::uint32_t far_chain) {
  const VertexId middle = positions.push_back(place);
  first.push_back(kNone);
  for (const std::uint32_t c : corners_at_edge(v, w)) {
    // (p, q, r) with the edge from p to q becomes (p, middle, r) and (middle, q, r).
    const FaceId f = face_of(c);
    const std::uint32_t of_q = after(c), of_r = before(c);
    const VertexId p = vertex(c), q = vertex(of_q), r = vertex(of_r);
    const auto added = static_cast<std::uint32_t>(next.size());
    faces.push_back({middle, q, r});
    origin.push_back(origin[f]);
    is_of_plane.push_back(is_of_plane[f]);
    next.resize(next.size() + 3, kNone);
    chain.insert(chain.end(), {p == v ? far_chain : chain[c], chain[of_q], kNone});
    if (p != v) chain[c] = far_chain;
    chain[of_q] = kNone;
    unlink(of_q);
    faces[f][of_q % 3] = middle;
    push(middle, of_q);
    push(middle, added);
    push(q, added + 1);
    push(r, added + 2);
  }
}

bool Sheet::are_joined(VertexId a, VertexId b) const {
  for (std::uint32_t c = first[a]; c != kNone; c = next[c])
    if (vertex(after(c)) == b || vertex(before(c)) == b) return true;
  return false;
}

std::uint32_t Sheet::corner_at_edge(VertexId from, VertexId to) const {
  for (std::uint32_t c = first[from]; c != kNone; c = next[c])
    if (vertex(after(c)) == to) return c;
  return kNone;
}

std::vector<std::uint32_t> Sheet::corners_at_edge(VertexId v, VertexId w) const {
  std::vector<std::uint32_t> corners;
  for_star(v, [&](std::uint32_t c) {
    if (vertex(after(c)) == w) corners.push_back(c);
    if (vertex(before(c)) == w) corners.push_back(before(c));
  });
  return corners;
}

bool Sheet::can_join(VertexId from, VertexId to) const {
  if (!has_small_star(from) || !has_small_star(to)) return false;
  std::array<VertexId, 2> apexes;
  std::size_t apex_count = 0;
  for (std::uint32_t c = first[from]; c != kNone; c = next[c]) {
    const std::uint32_t ahead = after(c), back = before(c);
    const bool is_ahead = vertex(ahead) == to;
    if (!is_ahead && vertex(back) != to) continue;
    if (apex_count == 2) return false;
    apexes[apex_count++] = vertex(is_ahead ? back : ahead);
    if (chain[ahead] != kNone && chain[is_ahead ? back : c] != kNone) return false;
  }
  if (apex_count == 0 || (apex_count == 2 && apexes[0] == apexes[1])) return false;
  const auto is_apex = [&](VertexId v) { return v == apexes[0] || (apex_count == 2 && v == apexes[1]); };
  // No other vertex is a neighbour of both ends, and no face with both apexes is at both ends.
  bool is_closing = false;
  for (std::uint32_t c = first[from]; c != kNone; c = next[c]) {
    const VertexId v = vertex(after(c)), w = vertex(before(c));
    if (v == to || w == to) continue;
    if (apex_count == 2 && is_apex(v) && is_apex(w)) is_closing = true;
    if ((!is_apex(v) && are_joined(to, v)) || (!is_apex(w) && are_joined(to, w))) return false;
  }
  if (!is_closing) return true;
  for (std::uint32_t c = first[to]; c != kNone; c = next[c])
    if (is_apex(vertex(after(c))) && is_apex(vertex(before(c)))) return false;
  return true;
}

}  // namespace remesh
