#include "core/free_form/coarsen.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/stoppable.h"
#include "core/free_form/input_surface.h"
#include "core/free_form/kept_volume.h"
#include "core/free_form/minor_features.h"
#include "core/free_form/ordered_input.h"
#include "core/free_form/sheet_operators.h"
#include "core/free_form/sheet_order.h"
#include "core/free_form/sheet_split.h"

namespace remesh {
namespace {

/// Parts have about this many vertices. Smaller ones leave more vertices at their borders, which stay.
constexpr std::size_t kPartVertices = 4000;
/// The shares of the tolerance that sweeps may use. What borders of parts leave behind in early sweeps is small.
constexpr std::array<double, 3> kShares{0.125, 0.25, 0.5};
/// Sweeps with the whole tolerance end when one has removed less than this share of the vertices.
constexpr double kFewJoined = 0.01;
constexpr int kMaxSweeps = 12;
constexpr int kMaxSteps = 8;
constexpr std::size_t kSamplesOfFace = 4, kSamplesAlways = 1 << 16;
/// In a sweep with the whole tolerance, angles are improved so often.
constexpr int kImprovements = 3;
/// Samples of faces and edges of the input are this far apart at most, in the root of tolerance times diagonal. That is
/// in proportion to the edges of the result. A face or an edge has at most kMaxSteps of them in a row. If all together
/// are more than these, they are farther apart.
constexpr double kSpacing = 0.25;
/// A face is narrow if its smallest angle is below the one with this cosine: 10 degrees.
constexpr double kNarrow = 0.985;
/// Narrow faces are split in at most so many rounds, until so many did not leave fewer of them than any before, and
/// while there are at most so many times the faces of the input.
constexpr int kMaxSplits = 8, kVainSplits = 2;
constexpr std::size_t kFacesOfSplits = 4;

/// Returns the vertices that are left, ascending.
std::vector<VertexId> vertices_of(const Sheet& sheet) {
  std::vector<VertexId> left;
  for (VertexId v(0); v.value < sheet.positions.size(); ++v.value)
    if (sheet.is_alive(v)) left.push_back(v);
  return left;
}

/// Makes the sheet of a surface, with its chain edges.
Sheet make_sheet(const OrderedInput& input, SheetWitnesses& witnesses, RunControl& control) {
  Sheet sheet;
  sheet.positions = input.positions;
  sheet.faces = input.faces;
  sheet.origin.reserve(input.faces.size());
  for (FaceId f(0); f.value < input.faces.size(); ++f.value) sheet.origin.push_back(f);
  if (input.is_of_plane.empty())
    sheet.is_of_plane.assign(input.faces.size(), 0);
  else
    sheet.is_of_plane.items() = input.is_of_plane;
  sheet.chain.assign(3 * input.faces.size(), kNone);
  sheet.kind.assign(input.positions.size(), Sheet::Kind::kFree);
  sheet.link(control);
  std::uint32_t chains = 0;
  StopCheck check(control);
  for (std::uint32_t h = 0; h < sheet.chain.size(); ++h) {
    check();
    const std::uint32_t twin = input.twins[h];
    if (sheet.chain[h] != kNone || (twin != kNone && input.edges[h] == FreeForm::Edge::kSmooth)) continue;
    sheet.chain[h] = chains++;
    if (twin != kNone) sheet.chain[twin] = sheet.chain[h];
    const bool is_plane = sheet.is_of_plane[Sheet::face_of(h)] != 0;
    sheet.is_at_plane.push_back(is_plane || (twin != kNone && sheet.is_of_plane[Sheet::face_of(twin)] != 0) ? 1 : 0);
  }
  witnesses.of_chain.assign(chains, kNone);
  return sheet;
}

/// Returns whether the faces around a vertex are one fan, in which they follow each other across edges of two faces.
bool is_one_fan(const Sheet& sheet, const std::vector<std::uint32_t>& twins, VertexId v) {
  std::size_t faces = 0, found = 1;
  sheet.for_star(v, [&](std::uint32_t) { ++faces; });
  const std::uint32_t first = sheet.first[v];
  std::uint32_t c = twins[Sheet::before(first)];
  for (; c != kNone && c != first; c = twins[Sheet::before(c)]) ++found;
  if (c == first) return found == faces;
  for (c = twins[first]; c != kNone; c = twins[Sheet::after(c)]) ++found;
  return found == faces;
}

/// Finds the vertices on chains, and those at which chains or the surface branch.
void classify(const OrderedInput& input, Sheet& sheet, SheetWitnesses& witnesses, RunControl& control) {
  witnesses.of_vertex.assign(sheet.positions.size(), kNone);
  StopCheck check(control);
  for (VertexId v(0); v.value < sheet.positions.size(); ++v.value) {
    check();
    std::array<VertexId, 2> ends;
    std::size_t count = 0;
    const auto add_end = [&](std::uint32_t half_edge, std::uint32_t end) {
      if (sheet.chain[half_edge] == kNone) return;
      const VertexId w = sheet.vertex(end);
      if ((count > 0 && ends[0] == w) || (count > 1 && ends[1] == w)) return;
      if (count < 2) ends[count] = w;
      ++count;
    };
    sheet.for_star(v, [&](std::uint32_t c) {
      add_end(c, Sheet::after(c));
      add_end(Sheet::before(c), Sheet::before(c));
    });
    const bool is_held = !input.is_held.empty() && input.is_held[v.value] != 0;
    if (is_held || (count != 0 && count != 2) || !is_one_fan(sheet, input.twins, v)) {
      sheet.kind[v] = Sheet::Kind::kFixed;
    } else if (count == 2) {
      sheet.kind[v] = Sheet::Kind::kChain;
      witnesses.of_vertex[v] = static_cast<std::uint32_t>(witnesses.on_chains.size());
      float share = 1;
      if (!input.shares.empty())
        sheet.for_star(v, [&](std::uint32_t c) { share = std::min(share, input.shares[c / 3]); });
      witnesses.on_chains.push_back({sheet.positions[v], v, share, kNone});
    }
  }
}

/// Calls take(f, place) for the samples of the faces and edges, and for the vertices. Each edge and each vertex is told
/// with one of its faces. Faces of planes have no samples: they stay in their planes, and chains have samples.
template <class Take>
void for_samples(const OrderedInput& input, const Sheet& sheet, double spacing, RunControl& control, const Take& take) {
  const auto steps = [](double length, double apart) {
    return std::clamp(static_cast<int>(std::ceil(length / apart)), 1, kMaxSteps);
  };
  StopCheck check(control);
  for (FaceId f(0); f.value < sheet.faces.size(); ++f.value) {
    check();
    if (sheet.is_of_plane[f] != 0) continue;
    const Triangle& t = sheet.faces[f];
    const Vec3 &a = sheet.positions[t[0]], &b = sheet.positions[t[1]], &c = sheet.positions[t[2]];
    const double own_spacing =
        spacing * (input.shares.empty() ? 1 : std::sqrt(static_cast<double>(input.shares[f.value])));
    const int n = steps(std::max({norm(b - a), norm(c - b), norm(a - c)}), own_spacing);
    for (int i = 0; i < n; ++i)
      for (int j = 0; i + j < n; ++j)
        take(f, (1.0 / (3 * n)) * ((3.0 * i + 1) * a + (3.0 * j + 1) * b + (3.0 * (n - i - j) - 2) * c));
    for (std::uint32_t k = 0; k < 3; ++k) {
      const std::uint32_t h = 3 * f.value + k;
      const std::uint32_t twin = input.twins[h];
      if (twin != kNone && twin < h && sheet.is_of_plane[Sheet::face_of(twin)] == 0) continue;
      const Vec3 &p = sheet.positions[t[k]], &q = sheet.positions[t[(k + 1) % 3]];
      const int pieces = steps(norm(q - p), own_spacing);
      for (int i = 1; i < pieces; ++i)
        take(f, (1.0 / pieces) * (static_cast<double>(pieces - i) * p + static_cast<double>(i) * q));
    }
  }
  for (VertexId v(0); v.value < sheet.positions.size(); ++v.value) {
    std::uint32_t c = sheet.first[v];
    while (c != kNone && sheet.is_of_plane[Sheet::face_of(c)] != 0) c = sheet.next[c];
    if (c != kNone) take(Sheet::face_of(c), sheet.positions[v]);
  }
}

/// Makes samples of the input the witnesses of its faces. There are no more than a few for each face.
void add_witnesses(const OrderedInput& input, const Sheet& sheet, double spacing, SheetWitnesses& witnesses,
                   RunControl& control) {
  const std::size_t enough = kSamplesOfFace * sheet.faces.size() + kSamplesAlways;
  std::size_t count = 0;
  for (;; spacing *= 2) {
    count = 0;
    for_samples(input, sheet, spacing, control, [&](FaceId, const Vec3&) { ++count; });
    if (count <= enough) break;
  }
  control.memory().ask_for<SheetWitnesses::Witness>(count);
  witnesses.all.reserve(count);
  witnesses.of_face.assign(sheet.faces.size(), kNone);
  for_samples(input, sheet, spacing, control, [&](FaceId f, const Vec3& place) {
    witnesses.all.push_back({place, f, witnesses.of_face[f]});
    witnesses.of_face[f] = static_cast<std::uint32_t>(witnesses.all.size() - 1);
  });
}

void add_quadrics(FreeSheet& free, RunControl& control) {
  const Sheet& sheet = free.sheet;
  free.quadrics.assign(sheet.positions.size(), {});
  StopCheck check(control);
  for (FaceId f(0); f.value < sheet.faces.size(); ++f.value) {
    check();
    if (sheet.is_of_plane[f] != 0) continue;
    const Triangle& t = sheet.faces[f];
    const Vec3 &a = sheet.positions[t[0]], &b = sheet.positions[t[1]], &c = sheet.positions[t[2]];
    const Vec3 area = cross(b - a, c - a), normal = normalized(area);
    for (const VertexId v : t) free.quadrics[v].add_plane(normal, a, norm(area));
    // At chains, a plane across the face keeps vertices near the edge.
    for (std::uint32_t k = 0; k < 3; ++k) {
      if (sheet.chain[3 * f.value + k] == kNone) continue;
      const Vec3 side = sheet.positions[t[(k + 1) % 3]] - sheet.positions[t[k]];
      const Vec3 across = normalized(cross(side, normal));
      for (const VertexId v : {t[k], t[(k + 1) % 3]})
        free.quadrics[v].add_plane(across, sheet.positions[t[k]], norm_squared(side));
    }
  }
}

/// A part may look at witnesses this many times for each witness that it has, and so many times more. Good surfaces
/// take up to 45 looks.
constexpr std::uint64_t kLooks = 256, kLooksAlways = 1 << 16;

bool is_any_at_plane(const Sheet& sheet) {
  return std::find(sheet.is_at_plane.begin(), sheet.is_at_plane.end(), 1) != sheet.is_at_plane.end();
}

/// Works on all parts of a sheet.
/// Output: how many vertices were joined.
std::uint64_t sweep(FreeSheet& free, const InputSurface& surface, const SheetRules& rules, bool is_last, int turn,
                    RunControl& control) {
  if (turn > 0)
    rearrange(free, order_along_curve(free.sheet.positions, vertices_of(free.sheet), turn, control), control);
  const std::size_t n = free.sheet.positions.size();
  const std::size_t parts = std::max<std::size_t>(1, (n + kPartVertices / 2) / kPartVertices);
  std::vector<std::uint32_t> tried(3 * free.sheet.faces.size(), 0);
  IdVector<VertexId, std::uint32_t> changed(n, 0);
  std::vector<std::uint64_t> joined(parts, 0);
  SheetRules bounded = rules;
  bounded.max_steps = kLooks * (free.witnesses.all.size() / parts) + kLooksAlways;
  for_all(0, parts, [&](std::size_t i) {
    SheetPart part(free, surface, bounded, VertexId(n * i / parts), VertexId(n * (i + 1) / parts), tried, changed,
                   control);
    part.join_vertices();
    for (int pass = 0; is_last && pass < kImprovements; ++pass) {
      part.improve_angles();
      part.join_vertices();
    }
    joined[i] = part.joined();
  });
  // A face of a plane may be long, and belong to vertices in several parts. There are few vertices at planes.
  if (is_any_at_plane(free.sheet)) {
    SheetPart whole(free, surface, bounded, VertexId(0), VertexId(n), tried, changed, control);
    whole.join_at_planes();
    joined.push_back(whole.joined());
  }
  return std::accumulate(joined.begin(), joined.end(), std::uint64_t{0});
}

/// Returns the faces that are narrow, ascending.
std::vector<FaceId> narrow_faces(const Sheet& sheet, double max_cosine_of_goal, RunControl& control) {
  std::vector<FaceId> narrow;
  StopCheck check(control);
  for (FaceId f(0); f.value < sheet.faces.size(); ++f.value) {
    check();
    if (sheet.is_alive(f) && sheet.is_of_plane[f] == 0 &&
        max_cosine(sheet.corners_of(f)) > std::max(kNarrow, max_cosine_of_goal))
      narrow.push_back(f);
  }
  return narrow;
}

/// Returns the faces of a sheet that are to be split because of faults, ascending.
std::vector<FaceId> faces_at(const CoarseningFaults& faults, const OrderedInput& input, const FreeSheet& free) {
  const std::size_t n = free.sheet.faces.size();
  std::vector<std::uint8_t> is_unanswered(input.faces.size(), 0), is_wanted(n, 0);
  for (const FaceId f : faults.far_input_faces) is_unanswered[f.value] = 1;
  for (const FaceId f : faults.far_faces) is_wanted[f.value] = 1;
  for (const FaceId f : faults.crossing_faces) is_wanted[f.value] = 1;
  // Where no face of the sheet is known to be at fault, all count that answer for a part of the input's face.
  const auto for_answers = [&](const auto& take) {
    for (FaceId f(0); f.value < n; ++f.value)
      for (std::uint32_t w = free.witnesses.of_face[f]; w != kNone; w = free.witnesses.all[w].next)
        take(is_wanted[f.value], is_unanswered[input.face_before[free.witnesses.all[w].face].value]);
  };
  for_answers([](std::uint8_t wanted, std::uint8_t& unanswered) { unanswered = wanted != 0 ? 0 : unanswered; });
  for_answers([](std::uint8_t& wanted, std::uint8_t unanswered) { wanted |= unanswered; });
  std::vector<FaceId> faces;
  for (FaceId f(0); f.value < n; ++f.value)
    if (is_wanted[f.value] != 0) faces.push_back(f);
  return faces;
}

}  // namespace

struct CoarseSheet::State {
  State(const FreeForm& free_form, const CoarseningGoals& goals, RunControl& control)
      : input(in_order(free_form, control)),
        dropped(drop_minor_features(input, goals.tolerance, control)),
        surface(input.positions, input.faces, input.twins, input.shares, control) {
    Box3 box;
    for (const Vec3& p : input.positions) box.add(p);
    if (goals.is_volume_kept) kept_volume.emplace(input, control);
    rules = {goals.tolerance, std::cos(goals.min_angle_deg * std::numbers::pi / 180), box.diagonal(), 0};
    free.sheet = make_sheet(input, free.witnesses, control);
    classify(input, free.sheet, free.witnesses, control);
    free.source.reserve(input.positions.size());
    for (VertexId v(0); v.value < input.positions.size(); ++v.value) free.source.push_back(v);
    add_quadrics(free, control);
    add_witnesses(input, free.sheet, kSpacing * std::sqrt(goals.tolerance * rules.diagonal), free.witnesses, control);
  }

  OrderedInput input;
  std::uint64_t dropped;
  InputSurface surface;
  SheetRules rules;
  FreeSheet free;
  std::optional<KeptVolume> kept_volume;

  /// Splits narrow faces along their length: where the input is straight in one direction, it has no vertices there.
  void split_narrow_faces(std::vector<FaceId> narrow, RunControl& control);
  void improve_narrow_faces(double min_angle_deg, int turn, RunControl& control);
  void sweep_all(int turn, RunControl& control);
  void improve(std::span<const VertexId> vertices, RunControl& control);
  Coarsened result(RunControl& control);

 private:
  IdVector<VertexId, double> weights_of_moves() const;
};

/// Returns the share of the tolerance at each vertex that has moved and may move anywhere; 0 for the others.
IdVector<VertexId, double> CoarseSheet::State::weights_of_moves() const {
  const Sheet& sheet = free.sheet;
  IdVector<VertexId, double> weights(sheet.positions.size(), 1);
  for (FaceId f(0); f.value < sheet.faces.size(); ++f.value) {
    double share = 1;
    for (std::uint32_t w = free.witnesses.of_face[f]; w != kNone; w = free.witnesses.all[w].next)
      share = std::min(share, surface.share(free.witnesses.all[w].face));
    for (const VertexId v : sheet.faces[f]) weights[v] = std::min(weights[v], share);
  }
  for (VertexId v(0); v.value < weights.size(); ++v.value)
    if (free.source[v].is_valid() || sheet.kind[v] != Sheet::Kind::kFree) weights[v] = 0;
  return weights;
}

void CoarseSheet::State::split_narrow_faces(std::vector<FaceId> narrow, RunControl& control) {
  const auto can_change = [&](FaceId f) {
    const Triangle& t = free.sheet.faces[f];
    return std::any_of(t.begin(), t.end(), [&](VertexId v) { return free.sheet.kind[v] != Sheet::Kind::kFixed; });
  };
  std::size_t fewest = narrow.size();
  for (int round = 0, vain = 0; round < kMaxSplits && vain < kVainSplits; ++round) {
    std::erase_if(narrow, [&](FaceId f) { return !can_change(f); });
    if (narrow.empty() || free.sheet.faces.size() + 2 * narrow.size() > kFacesOfSplits * input.faces.size()) break;
    improve(SheetSplitter(free, surface, control).split(narrow, SheetSplitter::Place::kMiddle), control);
    narrow = narrow_faces(free.sheet, rules.max_cosine, control);
    vain = narrow.size() < fewest ? 0 : vain + 1;
    fewest = std::min(fewest, narrow.size());
  }
}

/// Makes small angles around some vertices larger.
void CoarseSheet::State::improve(std::span<const VertexId> vertices, RunControl& control) {
  std::vector<std::uint32_t> tried(3 * free.sheet.faces.size(), 0);
  const std::size_t n = free.sheet.positions.size();
  IdVector<VertexId, std::uint32_t> changed(n, 0);
  SheetRules bounded = rules;
  bounded.max_steps = kLooks * free.witnesses.all.size() + kLooksAlways;
  SheetPart whole(free, surface, bounded, VertexId(0), VertexId(n), tried, changed, control);
  for (int pass = 0; pass < kImprovements; ++pass) whole.improve_angles(vertices);
}

/// Numbers what is left by its places, and tells where it comes from.
Coarsened CoarseSheet::State::result(RunControl& control) {
  rearrange(free, order_along_curve(free.sheet.positions, vertices_of(free.sheet), 0, control), control);
  const Sheet& sheet = free.sheet;
  Coarsened result;
  result.dropped_features = dropped;
  result.nearest.resize(sheet.faces.size());
  for_blocks(sheet.faces.size(), 64, control, [&](std::size_t begin, std::size_t end) {
    for (FaceId f(begin); f.value < end; ++f.value) {
      if (sheet.is_of_plane[f] != 0) {
        result.nearest[f] = input.face_before[sheet.origin[f]];
        continue;
      }
      const Triangle& t = sheet.faces[f];
      const Vec3 centre = (1.0 / 3) * (sheet.positions[t[0]] + sheet.positions[t[1]] + sheet.positions[t[2]]);
      const std::uint32_t w = free.witnesses.of_face[f];
      const FaceId start = w == kNone ? sheet.origin[f] : free.witnesses.all[w].face;
      result.nearest[f] = input.face_before[surface.nearest_face(centre, start)];
    }
  });
  for (const FaceId f : sheet.origin) result.origin.push_back(input.face_before[f]);
  result.answers.resize(input.faces.size());
  for (FaceId f(0); f.value < sheet.faces.size(); ++f.value)
    for (std::uint32_t w = free.witnesses.of_face[f]; w != kNone; w = free.witnesses.all[w].next)
      result.answers[input.face_before[free.witnesses.all[w].face]] = f;
  for (const VertexId v : free.source) result.source.push_back(v.is_valid() ? input.vertex_before[v] : VertexId());
  result.positions =
      kept_volume ? kept_volume->places(sheet, weights_of_moves(), rules.tolerance, control) : sheet.positions;
  result.faces = sheet.faces;
  return result;
}

/// Sweeps with the whole tolerance until hardly any vertices can be joined.
/// Input: `turn` is the number of sweeps before.
void CoarseSheet::State::sweep_all(int turn, RunControl& control) {
  for (; turn < kMaxSweeps; ++turn) {
    const std::uint64_t joined = sweep(free, surface, rules, true, turn, control);
    if (static_cast<double>(joined) < kFewJoined * static_cast<double>(free.sheet.positions.size())) break;
  }
}

/// Splits narrow faces and sweeps again. The sheet stays as it is unless fewer of them are left and fewer triangles
/// needed.
void CoarseSheet::State::improve_narrow_faces(double min_angle_deg, int turn, RunControl& control) {
  if (narrow_faces(free.sheet, rules.max_cosine, control).empty()) return;
  rearrange(free, order_along_curve(free.sheet.positions, vertices_of(free.sheet), turn, control), control);
  std::vector<FaceId> narrow = narrow_faces(free.sheet, rules.max_cosine, control);
  const std::size_t narrow_before = narrow.size();
  const auto needed = [&] { return triangles_needed(free.sheet.positions, free.sheet.faces, min_angle_deg, control); };
  const double needed_before = needed();
  control.memory().ask_for<SheetWitnesses::Witness>(free.witnesses.all.size());
  FreeSheet before = free;
  split_narrow_faces(std::move(narrow), control);
  sweep_all(turn, control);
  const bool is_better =
      narrow_faces(free.sheet, rules.max_cosine, control).size() < narrow_before && needed() < needed_before;
  if (!is_better) free = std::move(before);
}

CoarseSheet::CoarseSheet(const FreeForm& input, const CoarseningGoals& goals, RunControl& control)
    : state_(std::make_unique<State>(input, goals, control)) {
  FreeSheet& free = state_->free;
  SheetRules rules = state_->rules;
  int turn = 0;
  for (const double share : kShares) {
    rules.tolerance = share * goals.tolerance;
    sweep(free, state_->surface, rules, false, turn++, control);
  }
  state_->sweep_all(turn, control);
  if (goals.min_angle_deg > 0) state_->improve_narrow_faces(goals.min_angle_deg, turn, control);
  result_ = state_->result(control);
}

CoarseSheet::~CoarseSheet() = default;

bool CoarseSheet::refine(const CoarseningFaults& faults, bool are_all_moved, RunControl& control) {
  FreeSheet& free = state_->free;
  const std::size_t before = free.sheet.faces.size();
  SheetSplitter splitter(free, state_->surface, control);
  bool is_changed = splitter.move_to_input(faults.crossing_faces);
  if (are_all_moved && splitter.move_to_input(faults.far_faces)) is_changed = true;
  const std::vector<VertexId> touched =
      splitter.split(faces_at(faults, state_->input, free), SheetSplitter::Place::kInput);
  state_->improve(touched, control);
  if (free.sheet.faces.size() > before) is_changed = true;
  result_ = state_->result(control);
  return is_changed;
}

}  // namespace remesh
