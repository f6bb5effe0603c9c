#include "core/verify/near_faces/near_faces.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/coordinate_range.h"
#include "core/geometry/trees/box_tree.h"
#include "core/verify/near_faces/distance_target.h"
#include "core/verify/near_faces/face_piece.h"

namespace remesh::verification {
namespace {

constexpr std::size_t kFacesPerBlock = 256;
/// The pieces of a block that may wait while other pieces are cut. Good surfaces need fewer than 60.
constexpr std::size_t kMaxWaiting = 512;
/// Distances that differ by less count as the same. It covers the rounding of two distances and of some cuts.
constexpr double kSame = 0x1p-44;
/// A place that is nearer to a wall than this counts as on it.
constexpr double kOnWall = 0x1p-48;

/// The cube of local coordinates. They are within [-1, 1].
/// Holds:   a local coordinate is rounded once, by at most 2^-54.
struct LocalSpace {
  Vec3 centre;
  double unit = 1;  ///< model units per local unit, a power of two

  Vec3 to_local(const Vec3& p) const {
    const Vec3 d = p - centre;
    return {d.x / unit, d.y / unit, d.z / unit};
  }
  Vec3 to_model(const Vec3& p) const { return unit * p + centre; }
  /// A length in model units that is not below the exact one.
  double to_model(double length) const { return std::nextafter(unit * length, HUGE_VAL); }
};

Box3 box_of(const TriangleSet& set, RunControl& control) {
  Box3 all;
  for (const Box3& box :
       map_blocks<Box3>(set.faces.size(), kItemsPerBlock, control, [&](std::size_t f, std::size_t end) {
         Box3 box;
         for (; f < end; ++f)
           for (const VertexId v : set.faces[f]) box.add(set.positions[v.value]);
         return box;
       }))
    all.add(box);
  return all;
}

LocalSpace space_around(const Box3& box) {
  LocalSpace space;
  space.centre = 0.5 * box.min + 0.5 * box.max;
  const Vec3 half = box.max - space.centre;
  const double largest = std::max({half.x, half.y, half.z});
  if (!(largest < CoordinateRange::kFarthest))
    throw Error(Code::kCoordinateRange, Stage::kVerify, "the two surfaces are too far from each other to be compared");
  int exponent = 0;
  if (largest > 0) std::frexp(largest, &exponent);
  // One more power of two leaves room for the rounding of the centre.
  space.unit = std::ldexp(1.0, exponent);
  return space;
}

/// A surface in local coordinates, with a tree over its faces.
class LocalFaces {
 public:
  LocalFaces(const TriangleSet& set, const LocalSpace& space, RunControl& control)
      : points_(set.positions.size()), faces_(set.faces) {
    for_blocks(points_.size(), kItemsPerBlock, control, [&](std::size_t v, std::size_t end) {
      for (; v < end; ++v) points_[v] = space.to_local(set.positions[v]);
    });
    const auto entries = Tree::make_entries(faces_.size(), control, [&](std::size_t f, Tree::Entry& entry) {
      for (const VertexId v : faces_[f]) entry.box.add(points_[v.value]);
    });
    tree_ = Tree(entries, control);
  }

  std::size_t size() const { return faces_.size(); }
  /// The faces in an order in which faces that are near each other in space are near each other.
  std::uint32_t in_order(std::size_t i) const { return tree_.number(i); }
  Corners3 corners(std::uint32_t f) const {
    const Triangle& face = faces_[f];
    return {points_[face[0].value], points_[face[1].value], points_[face[2].value]};
  }

  struct Nearest {
    std::uint32_t face;
    double squared;
  };
  /// Returns `known`, or a face that is nearer to p.
  Nearest nearer(const Vec3& p, Nearest known) const {
    tree_.search(
        known.squared, [&](const Tree::Entry& entry) { return squared_distance(entry.box, p); },
        [&](std::size_t slot) {
          const double squared = DistanceTarget(corners(tree_.number(slot))).squared_distance(p);
          if (squared < known.squared) known = {tree_.number(slot), squared};
        });
    return known;
  }

 private:
  using Tree = BoxTree<NoTag>;

  std::vector<Vec3, DefaultInit<Vec3>> points_;
  std::span<const Triangle> faces_;
  Tree tree_;
};

/// The wall between two triangles with a common side: the plane through the side that halves the angle between them.
/// Places on its positive side are nearer to the second one than to the first one's plane.
struct Wall {
  Vec3 on, normal;
  bool exists = false;
  bool is_end = false;  ///< the triangles have only a corner in common
};
/// If the triangles have only a corner in common, it is the end of the first one: a plane across it through a side at
/// that corner, the one beyond which `worst` is further. So the cuts around a vertex go through the vertex.
Wall wall_between(const Corners3& from, const Corners3& to, const Vec3& worst) {
  // Returns the direction from a side to the third corner, across the side.
  const auto into = [](const Vec3& p, const Vec3& q, const Vec3& apex) {
    const Vec3 along = normalized(q - p), d = apex - p;
    return normalized(d - dot(d, along) * along);
  };
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vec3 &p = from[i], &q = from[(i + 1) % 3];
      const bool is_same_way = p == to[j] && q == to[(j + 1) % 3], is_opposite = p == to[(j + 1) % 3] && q == to[j];
      if (!is_same_way && !is_opposite) continue;
      const Vec3 normal = into(p, q, to[(j + 2) % 3]) - into(p, q, from[(i + 2) % 3]);
      constexpr double kFolded = 0x1p-10;
      return {p, normalized(normal), norm(normal) > kFolded};
    }
  Wall end;
  double farthest = 0;
  for (int i = 0; i < 3; ++i) {
    if (std::find(to.begin(), to.end(), from[i]) == to.end()) continue;
    for (const int side : {i, (i + 2) % 3}) {
      const Vec3 outwards = -into(from[side], from[(side + 1) % 3], from[(side + 2) % 3]);
      const double beyond = dot(worst - from[i], outwards);
      if (beyond <= farthest) continue;
      farthest = beyond;
      end = {from[i], outwards, true, true};
    }
  }
  return end;
}

/// The result of one block of faces.
struct BlockOutcome {
  OneWayDistance found;  ///< in local units
  bool is_finished = true;
};

/// Measures the faces of one block. Lengths are in local units.
class BlockMeasure {
 public:
  /// Input:  `tolerance` - negative if there is none; `known` - a distance that some point is known to have;
  ///         `max_pieces` - when so many pieces have been measured, the rest is not cut any more; `is_last` - the block
  ///         is not measured again, so that each face needs a bound now.
  BlockMeasure(const LocalFaces& from, const LocalFaces& to, double tolerance, double known, std::uint64_t max_pieces,
               bool is_last, const RunControl& control)
      : from_(from),
        to_(to),
        tolerance_(tolerance),
        known_(known),
        max_pieces_(max_pieces),
        is_last_(is_last),
        control_(control) {
    out_.found.distance = -1;
  }

  BlockOutcome run(std::size_t begin, std::size_t end) {
    std::uint32_t guess = kNone;
    for (std::size_t i = begin; i < end; ++i) {
      const std::uint32_t f = from_.in_order(i);
      guess = measure(f, guess);
      if (!out_.is_finished && !is_last_) break;
    }
    return std::move(out_);
  }

 private:
  using Values = std::array<double, FacePiece::kMaxCorners>;  ///< one for each corner of a piece

  /// How far the corners of a piece are from its target.
  struct Corners {
    Values squared;
    std::uint32_t worst = 0;
    double bound = 0;  ///< no point of the piece is farther than this
  };

  std::uint32_t measure(std::uint32_t f, std::uint32_t guess) {
    face_ = FaceId(f);
    is_far_ = false;
    bound_of_face_ = 0;
    FacePiece whole = whole_face(from_.corners(f), guess);
    if (guess == kNone || !is_done(whole, measured(whole))) {
      aim(whole, guess);
      waiting_.push_back(whole);
    }
    guess = whole.target;
    while (!waiting_.empty()) {
      control_.check();
      FacePiece piece = waiting_.back();
      waiting_.pop_back();
      settle(piece);
    }
    if (tolerance_ >= 0 && bound_of_face_ > tolerance_) {
      ++out_.found.far_count;
      out_.found.far_faces.push_back({face_, bound_of_face_});
    }
    return guess;
  }

  /// Measures a piece until it is done, or cuts it.
  void settle(FacePiece& piece) {
    for (;;) {
      const Corners here = measured(piece);
      if (is_done(piece, here)) return;
      if (out_.found.pieces >= max_pieces_ || waiting_.size() >= kMaxWaiting) return give_up(here);
      if (piece.cuts > 0 && is_large(piece)) return halve(piece);
      const Vec3 worst = piece.corners[here.worst];
      const LocalFaces::Nearest nearest = to_.nearer(worst, {piece.target, here.squared[here.worst]});
      note(worst, nearest);
      if (nearest.face == piece.target || is_below_rounding(piece)) return accept(here);
      if (is_done(piece, here)) return;
      if (is_large(piece)) return halve(piece);
      if (cut_towards(piece, here, nearest.face)) return;
      piece.target = nearest.face;
    }
  }

  Corners measured(const FacePiece& piece) {
    ++out_.found.pieces;
    const DistanceTarget target(to_.corners(piece.target));
    squared_size_of_target_ = target.squared_longest_side();
    Corners here;
    for (std::uint32_t i = 0; i < piece.count; ++i) {
      here.squared[i] = target.squared_distance(piece.corners[i]);
      if (here.squared[i] > here.squared[here.worst]) here.worst = i;
    }
    // The distance from a triangle is a convex function, so it is largest at a corner.
    here.bound = std::sqrt(here.squared[here.worst]) + (DistanceTarget::kRounding + piece.rounding());
    return here;
  }

  bool is_done(const FacePiece& piece, const Corners& here) {
    const bool is_tight =
        (tolerance_ < 0 || is_far_) && here.bound <= known_ * (1 + kBoundExcess) + (kSame + piece.rounding());
    if (!is_tight && here.bound > tolerance_) return false;
    accept(here);
    return true;
  }
  void accept(const Corners& here) {
    bound_of_face_ = std::max(bound_of_face_, here.bound);
    out_.found.bound = std::max(out_.found.bound, here.bound);
    if (here.bound > tolerance_) is_far_ = true;
  }
  void give_up(const Corners& here) {
    out_.is_finished = false;
    accept(here);
  }

  /// Takes notice of the distance of a point of the face.
  void note(const Vec3& p, const LocalFaces::Nearest& nearest) {
    const double distance = std::sqrt(nearest.squared);
    known_ = std::max(known_, distance);
    if (distance <= out_.found.distance) return;
    out_.found.distance = distance;
    out_.found.at = p;
    out_.found.face = face_;
    out_.found.other_face = FaceId(nearest.face);
  }

  /// Chooses the face that is nearest to the middle of a piece as its target.
  void aim(FacePiece& piece, std::uint32_t guess) {
    const Vec3 middle = piece.middle();
    LocalFaces::Nearest known{0, HUGE_VAL};
    if (guess != kNone) known = {guess, DistanceTarget(to_.corners(guess)).squared_distance(middle)};
    known = to_.nearer(middle, known);
    note(middle, known);
    piece.target = known.face;
  }

  /// A piece that is large beside its target is near many faces, so it is halved before it is measured again.
  bool is_large(const FacePiece& piece) const {
    constexpr double kSquaredRatio = 4;
    const std::uint32_t side = piece.longest_side();
    return norm_squared(piece.corners[piece.after(side)] - piece.corners[side]) >
           kSquaredRatio * squared_size_of_target_;
  }
  static bool is_below_rounding(const FacePiece& piece) {
    const std::uint32_t side = piece.longest_side();
    return norm_squared(piece.corners[piece.after(side)] - piece.corners[side]) <= kSame * kSame;
  }

  void halve(const FacePiece& piece) {
    const CutPiece parts = halve_piece(piece);
    for (const FacePiece* const part : {&parts.inner, &parts.outer}) {
      waiting_.push_back(*part);
      aim(waiting_.back(), piece.target);
    }
  }

  /// Cuts a piece between its target and another face, which is nearer to the piece's worst corner.
  /// Output: false if the other face is at least as near to all corners.
  bool cut_towards(const FacePiece& piece, const Corners& here, std::uint32_t other) {
    const Corners3 target_corners = to_.corners(piece.target), other_corners = to_.corners(other);
    const DistanceTarget target(target_corners), nearer(other_corners);
    const auto gain_at = [&](const Vec3& p) { return target.squared_distance(p) - nearer.squared_distance(p); };
    Values gain;
    bool is_all = true;
    for (std::uint32_t i = 0; i < piece.count; ++i) {
      gain[i] = gain_at(piece.corners[i]);
      is_all = is_all && gain[i] >= 0;
    }
    if (is_all) return false;
    if (piece.count == FacePiece::kMaxCorners) {
      halve(piece);
      return true;
    }
    const Wall wall = wall_between(target_corners, other_corners, piece.corners[here.worst]);
    Values beyond;
    double lowest = 0, highest = 0;
    for (std::uint32_t i = 0; i < piece.count && wall.exists; ++i) {
      beyond[i] = dot(piece.corners[i] - wall.on, wall.normal);
      if (std::fabs(beyond[i]) <= kOnWall) beyond[i] = 0;
      lowest = std::min(lowest, beyond[i]);
      highest = std::max(highest, beyond[i]);
    }
    // An end that cuts off next to nothing would be tried again and again.
    constexpr double kMinPart = 0x1p-4;
    const double min_part = wall.is_end ? kMinPart * (highest - lowest) : 0;
    if (wall.exists && lowest < -min_part && beyond[here.worst] > min_part) {
      push_parts(piece, beyond, here.worst, other, [&](std::uint32_t i) {
        return std::clamp(beyond[i] / (beyond[i] - beyond[piece.after(i)]), 0.0, 1.0);
      });
    } else {
      push_parts(piece, gain, here.worst, other,
                 [&](std::uint32_t i) { return place_of_equal(piece, i, gain, gain_at); });
    }
    return true;
  }

  /// Finds where on the side from corner i the gain changes its sign, roughly.
  template <class GainAt>
  static double place_of_equal(const FacePiece& piece, std::uint32_t i, const Values& gain, const GainAt& gain_at) {
    constexpr int kSteps = 4;
    // Each step stays off the ends of the interval, so that the interval shrinks. The cut stays off the ends of the
    // side, so that both parts of the piece are smaller than the piece.
    constexpr double kMinStep = 0.125, kMinShare = 0x1p-4;
    const Vec3 &p = piece.corners[i], &q = piece.corners[piece.after(i)];
    double low = 0, high = 1, gain_low = gain[i], gain_high = gain[piece.after(i)];
    for (int step = 0; step < kSteps && gain_low != gain_high; ++step) {
      const double share = std::clamp(gain_low / (gain_low - gain_high), kMinStep, 1 - kMinStep);
      const double t = low + (high - low) * share, here = gain_at(p + t * (q - p));
      const bool is_as_low = (here > 0) == (gain_low > 0);
      (is_as_low ? low : high) = t;
      (is_as_low ? gain_low : gain_high) = here;
    }
    return std::clamp(0.5 * (low + high), kMinShare, 1 - kMinShare);
  }

  /// Cuts off the corners around `worst` with a positive value, which get `other` as their target.
  /// Input:  some corner has a negative value; place(i) is the share of the side from corner i at which to cut it.
  template <class Place>
  void push_parts(const FacePiece& piece, const Values& value, std::uint32_t worst, std::uint32_t other,
                  const Place& place) {
    std::uint32_t first = worst, last = worst;
    while (value[piece.before(first)] > 0) first = piece.before(first);
    while (value[piece.after(last)] > 0) last = piece.after(last);
    const std::uint32_t before = piece.before(first);
    const double s = value[before] == 0 ? 0 : place(before), t = value[piece.after(last)] == 0 ? 1 : place(last);
    const bool is_inner = before < last;
    const CutPiece parts = is_inner ? cut_piece(piece, before, s, last, t) : cut_piece(piece, last, t, before, s);
    waiting_.push_back(is_inner ? parts.outer : parts.inner);
    waiting_.push_back(is_inner ? parts.inner : parts.outer);
    waiting_.back().target = other;
  }

  const LocalFaces &from_, &to_;
  const double tolerance_;
  double known_;
  const std::uint64_t max_pieces_;
  const bool is_last_;
  const RunControl& control_;

  BlockOutcome out_;
  std::vector<FacePiece> waiting_;
  double squared_size_of_target_ = 0;  ///< that of the triangle that was measured last
  FaceId face_;
  bool is_far_ = false;  ///< the face is beyond the tolerance
  double bound_of_face_ = 0;
};

/// The share of the progress that one direction has.
struct Share {
  double from, width;
};

/// Measures all faces of one surface. Lengths are in local units.
class Measure {
 public:
  Measure(const LocalFaces& from, const LocalFaces& to, double tolerance, Share share, RunControl& control)
      : from_(from), to_(to), tolerance_(tolerance), share_(share), control_(control) {}

  /// Blocks get more and more pieces, in rounds. A block that does not get by with its pieces starts again in the next
  /// round, with the largest distance that the other blocks have found. All this depends on the surfaces alone.
  OneWayDistance run() {
    const std::size_t blocks = (from_.size() + kFacesPerBlock - 1) / kFacesPerBlock;
    std::vector<std::uint32_t> left(blocks);
    for (std::size_t b = 0; b < blocks; ++b) left[b] = static_cast<std::uint32_t>(b);
    // Two triangulations of one plane need some 30 pieces for each face of the finer one, and all others fewer.
    constexpr std::uint64_t kPerFace = 128, kAlways = 1 << 16, kGrowth = 8;
    std::uint64_t budget = kPerFace * (from_.size() + to_.size()) + kAlways;
    OneWayDistance all;
    all.distance = -1;
    for (std::uint64_t each = budget / (4 * kGrowth * blocks) + 1; !left.empty(); each *= kGrowth) {
      const bool is_last = each * kGrowth * left.size() > budget;
      if (is_last) each = std::max(each, budget / left.size());
      const std::vector<BlockOutcome> outcomes = run_blocks(left, all.distance, each, is_last);
      std::vector<std::uint32_t> again;
      for (std::size_t i = 0; i < left.size(); ++i) {
        const BlockOutcome& outcome = outcomes[i];
        budget -= std::min(budget, outcome.found.pieces);
        join(outcome, is_last, all);
        if (!outcome.is_finished && !is_last) again.push_back(left[i]);
      }
      left = std::move(again);
    }
    sort_far_faces(all.far_faces);
    return all;
  }

 private:
  std::vector<BlockOutcome> run_blocks(const std::vector<std::uint32_t>& left, double known, std::uint64_t each,
                                       bool is_last) {
    std::vector<BlockOutcome> outcomes(left.size());
    const double total = static_cast<double>((from_.size() + kFacesPerBlock - 1) / kFacesPerBlock);
    for_blocks(left.size(), 1, control_, [&](std::size_t i, std::size_t) {
      const std::size_t begin = left[i] * kFacesPerBlock, end = std::min(from_.size(), begin + kFacesPerBlock);
      BlockMeasure block(from_, to_, tolerance_, std::max(known, 0.0), each, is_last, control_);
      outcomes[i] = block.run(begin, end);
      if (outcomes[i].is_finished || is_last) {
        const std::lock_guard lock(mutex_);
        control_.progress(share_.from + share_.width * (++done_ / total));
      }
    });
    return outcomes;
  }

  static void join(const BlockOutcome& outcome, bool is_last, OneWayDistance& all) {
    const OneWayDistance& found = outcome.found;
    all.pieces += found.pieces;
    if (found.distance > all.distance) {
      all.distance = found.distance;
      all.at = found.at;
      all.face = found.face;
      all.other_face = found.other_face;
    }
    if (!outcome.is_finished && !is_last) return;
    all.is_coarse = all.is_coarse || !outcome.is_finished;
    all.bound = std::max(all.bound, found.bound);
    all.far_count += found.far_count;
    all.far_faces.insert(all.far_faces.end(), found.far_faces.begin(), found.far_faces.end());
    if (all.far_faces.size() > 2 * kMaxFarFaces) sort_far_faces(all.far_faces);
  }
  static void sort_far_faces(std::vector<FarFace>& faces) {
    std::sort(faces.begin(), faces.end(), [](const FarFace& a, const FarFace& b) {
      return a.bound != b.bound ? a.bound > b.bound : a.face < b.face;
    });
    if (faces.size() > kMaxFarFaces) faces.resize(kMaxFarFaces);
  }

  const LocalFaces &from_, &to_;
  const double tolerance_;
  const Share share_;
  RunControl& control_;
  std::mutex mutex_;
  double done_ = 0;
};

void to_model(const LocalSpace& space, OneWayDistance& distance) {
  distance.bound = space.to_model(distance.bound);
  distance.distance *= space.unit;
  distance.at = space.to_model(distance.at);
  for (FarFace& far : distance.far_faces) far.bound = space.to_model(far.bound);
}

}  // namespace

namespace {

/// Two surfaces in the same local unit.
class LocalPair {
 public:
  LocalPair(const TriangleSet& a, const TriangleSet& b, std::optional<double> tolerance, RunControl& control)
      : box_(box_of_both(a, b, control)),
        space_(space_around(box_)),
        a_(a, space_, control),
        b_(b, space_, control),
        // A bound is rounded up by one step when it is converted, so the tolerance is rounded down before.
        tolerance_(tolerance ? std::max(0.0, std::nextafter(*tolerance, 0) / space_.unit) : -1),
        control_(control) {}

  double diagonal() const { return box_.diagonal(); }
  OneWayDistance a_to_b(const Share& share) const { return measure(a_, b_, share); }
  OneWayDistance b_to_a(const Share& share) const { return measure(b_, a_, share); }

 private:
  static Box3 box_of_both(const TriangleSet& a, const TriangleSet& b, RunControl& control) {
    if (a.faces.empty() || b.faces.empty())
      throw Error(Code::kEmptyMesh, Stage::kVerify, "one of the two surfaces has no face");
    Box3 box = box_of(a, control);
    box.add(box_of(b, control));
    return box;
  }
  OneWayDistance measure(const LocalFaces& from, const LocalFaces& to, const Share& share) const {
    OneWayDistance distance = Measure(from, to, tolerance_, share, control_).run();
    to_model(space_, distance);
    return distance;
  }

  const Box3 box_;
  const LocalSpace space_;
  const LocalFaces a_, b_;
  const double tolerance_;
  RunControl& control_;
};

}  // namespace

TwoWayDistance distance_between(const TriangleSet& a, const TriangleSet& b, std::optional<double> tolerance,
                                RunControl& control) {
  const LocalPair pair(a, b, tolerance, control);
  TwoWayDistance both;
  both.diagonal = pair.diagonal();
  both.a_to_b = pair.a_to_b({0, 0.5});
  both.b_to_a = pair.b_to_a({0.5, 0.5});
  return both;
}

OneWayDistance distance_from(const TriangleSet& from, const TriangleSet& to, std::optional<double> tolerance,
                             RunControl& control) {
  return LocalPair(from, to, tolerance, control).a_to_b({0, 1});
}

}  // namespace remesh::verification
