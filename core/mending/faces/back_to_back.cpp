#include "core/mending/faces/back_to_back.h"

#include <algorithm>
#include <utility>

#include "core/base/stoppable.h"
#include "core/mending/faces/winding.h"
#include "core/mesh/face_geometry.h"

namespace remesh {
namespace {

/// A set of connected pairs.
struct Piece {
  std::vector<std::uint32_t> pairs;
  bool is_possible = true;  ///< the pairs have two consistent sides
  bool is_closed = true;    ///< the pairs border on no other faces
  bool are_labels_alike = true;
  /// The number of edges over which side 0 has the orientation of the neighbours, minus that for the other side.
  int votes = 0;
  double volume = 0;  ///< volume of side 0
};

class SideChoice {
 public:
  SideChoice(const Surface& surface, const Adjacency& edges, const BodyLabels& labels,
             std::span<const std::uint8_t> is_dropped, std::span<BackToBack> pairs, RunControl& control)
      : surface_(surface),
        edges_(edges),
        labels_(labels),
        is_dropped_(is_dropped),
        pairs_(pairs),
        control_(control),
        pair_of_(surface.face_count(), kNone),
        side_(pairs.size(), kUnknown) {}

  /// Output: the pieces that are shells of their own.
  std::vector<Piece> run() {
    StopCheck check(control_);
    for (std::uint32_t i = 0; i < pairs_.size(); ++i) {
      check();
      pair_of_[pairs_[i].first.value] = pair_of_[pairs_[i].second.value] = i;
    }
    std::vector<Piece> shells;
    for (std::uint32_t i = 0; i < pairs_.size(); ++i) {
      check();
      if (side_[i] != kUnknown) continue;
      Piece piece = walk(i);
      if (!piece.is_possible) continue;
      choose(piece);
      if (piece.is_closed) shells.push_back(std::move(piece));
    }
    return shells;
  }

 private:
  static constexpr std::uint8_t kUnknown = 2;

  bool is_first(FaceId f) const { return pairs_[pair_of_[f.value]].first == f; }

  /// Finds the piece of a pair. Sets for each of its pairs the face that is on side 0: 0 means the first face, 1 the
  /// second.
  Piece walk(std::uint32_t seed) {
    Piece piece;
    piece.pairs.push_back(seed);
    side_[seed] = 0;
    const Vec3 origin = surface_.local[surface_.face(pairs_[seed].first)[0]];
    for (std::size_t i = 0; i < piece.pairs.size(); ++i) {
      const std::uint32_t pair = piece.pairs[i];
      const FaceId first = pairs_[pair].first;
      piece.volume += (side_[pair] == 0 ? 1 : -1) * six_volumes_below(surface_, first, origin);
      if (!labels_.are_alike() && labels_.set_of[first.value] != labels_.set_of[pairs_[pair].second.value])
        piece.are_labels_alike = false;
      for (std::uint32_t h = surface_.face_begin[first.value]; h < surface_.face_begin[first.value + 1]; ++h)
        cross_edge(piece, pair, h);
    }
    return piece;
  }

  void cross_edge(Piece& piece, std::uint32_t pair, std::uint32_t h) {
    for (const std::uint32_t g : edges_.half_edges(edges_.edge_of(h))) {
      if (looks_++ % kLooks == 0) control_.check_and_move();
      const FaceId f = edges_.face_of(g);
      const bool do_agree = edges_.from(g) == edges_.to(h);
      const std::uint32_t other = pair_of_[f.value];
      if (other == pair || is_gone(f)) continue;
      if (other == kNone) {
        piece.is_closed = false;
        piece.votes += do_agree == (side_[pair] == 0) ? 1 : -1;
        continue;
      }
      if (!is_first(f)) continue;
      const std::uint8_t side = side_[pair] ^ static_cast<std::uint8_t>(!do_agree);
      if (side_[other] == kUnknown) {
        side_[other] = side;
        piece.pairs.push_back(other);
      } else if (side_[other] != side) {
        piece.is_possible = false;
      }
    }
  }

  bool is_gone(FaceId f) const { return pair_of_[f.value] == kNone && is_dropped_[f.value]; }

  void choose(const Piece& piece) {
    const std::uint32_t smallest = *std::min_element(piece.pairs.begin(), piece.pairs.end());
    std::uint8_t staying_side = side_[smallest];
    if (piece.votes != 0)
      staying_side = piece.votes > 0 ? 0 : 1;
    else if (!piece.are_labels_alike && piece.volume != 0)
      staying_side = piece.volume > 0 ? 0 : 1;
    for (const std::uint32_t pair : piece.pairs) pairs_[pair].does_first_stay = side_[pair] == staying_side;
  }

  static constexpr std::size_t kLooks = 4096;

  const Surface& surface_;
  const Adjacency& edges_;
  const BodyLabels& labels_;
  std::span<const std::uint8_t> is_dropped_;
  std::span<BackToBack> pairs_;
  RunControl& control_;
  std::vector<std::uint32_t> pair_of_;  ///< by face
  std::vector<std::uint8_t> side_;      ///< by pair
  std::size_t looks_ = 0;
};

/// Returns which faces would have the wrong orientation if only the faces in `stays` stayed.
std::vector<std::uint8_t> would_be_inside_out(const Surface& surface, const FaceLabels& labels,
                                              const std::vector<std::uint8_t>& stays, RunControl& control) {
  FaceList staying;
  StopCheck check(control);
  for (std::uint32_t i = 0; i < surface.face_count(); ++i) {
    check();
    const FaceId f(i);
    if (stays[i]) staying.add_face(surface.face(f), surface.face_source[f], surface.label(f));
  }
  Surface trial = surface;
  trial.take_faces(std::move(staying));
  const Adjacency edges(trial.vertex_count(), trial.face_begin, trial.corners, control);
  const InsideOutFaces found = find_inside_out_faces(trial, edges, labels, control);
  std::vector<std::uint8_t> result(surface.face_count(), 0);
  if (found.first.empty()) return result;
  std::size_t number = 0;
  for (std::size_t f = 0; f < result.size(); ++f) {
    check();
    if (stays[f]) result[f] = found.is_inside_out[number++];
  }
  return result;
}

}  // namespace

void choose_sides(const Surface& surface, const Adjacency& edges, const FaceLabels& labels, const BodyLabels& of_faces,
                  std::span<const std::uint8_t> is_dropped, std::span<BackToBack> pairs, RunControl& control) {
  const std::vector<Piece> shells = SideChoice(surface, edges, of_faces, is_dropped, pairs, control).run();
  if (shells.empty()) return;
  std::vector<std::uint8_t> stays(surface.face_count());
  for (std::size_t f = 0; f < stays.size(); ++f) stays[f] = !is_dropped[f];
  for (const BackToBack& pair : pairs) {
    stays[pair.first.value] = pair.does_first_stay;
    stays[pair.second.value] = !pair.does_first_stay;
  }
  const std::vector<std::uint8_t> is_wrong = would_be_inside_out(surface, labels, stays, control);
  StopCheck check(control);
  for (const Piece& shell : shells) {
    const BackToBack& any = pairs[shell.pairs[0]];
    if (!is_wrong[(any.does_first_stay ? any.first : any.second).value]) continue;
    for (const std::uint32_t pair : shell.pairs) {
      check();
      pairs[pair].does_first_stay = !pairs[pair].does_first_stay;
    }
  }
}

}  // namespace remesh
