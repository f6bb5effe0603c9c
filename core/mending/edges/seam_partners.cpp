#include "core/mending/edges/seam_partners.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <tuple>
#include <utility>

#include "core/base/blocks.h"
#include "core/base/loop_progress.h"
#include "core/base/stoppable.h"
#include "core/base/tolerance.h"
#include "core/base/union_find.h"
#include "core/mending/edges/relative_orientation.h"

namespace remesh {
namespace {

constexpr std::size_t kPartnerBlock = 256;

/// All pairs of edges that could be partners. Each pair is listed once.
struct Candidates {
  std::vector<SeamPair, DefaultInit<SeamPair>> pairs;
  bool is_complete = true;
};

Candidates find_candidates(const OpenEdges& open, const SeamRules& rules, RunControl& control) {
  const double tolerance = rules.tolerance;
  const auto is_worth_a_look = [&](const OpenEdge& edge) {
    return edge.length > 2 * tolerance && edge.height > kThinFace * tolerance;
  };
  LooksAtEdges looks(open.size());
  LoopProgress progress(control, open.size());
  const auto blocks =
      map_blocks<std::vector<SeamPair>>(open.size(), kPartnerBlock, control, [&](std::size_t begin, std::size_t end) {
        std::vector<SeamPair> pairs;
        // The radius is a little larger than the tolerance, so that rounding of the middles hides no edge at exactly
        // the tolerance.
        const double radius = tolerance * (1 + 1e-6) + 1e-300;
        for (std::size_t i = begin; i < end && !looks.are_too_many(); ++i) {
          if (!is_worth_a_look(open[i])) continue;
          looks.add(open.search(i, radius, control, [&](std::uint32_t j) {
            if (j <= i || !is_worth_a_look(open[j])) return;
            const Fit fit = open.fit(i, j, tolerance);
            if (fit.width <= tolerance && (rules.takes_alike || !fit.runs_alike))
              pairs.push_back({static_cast<std::uint32_t>(i), j, fit});
          }));
        }
        progress.add(end - begin);
        return pairs;
      });
  if (looks.are_too_many()) return {{}, false};
  return {concatenate<SeamPair>(blocks, control), true};
}

/// Knows which faces are connected over edges with two faces, or over edges that are each other's partners.
class Pieces {
 public:
  Pieces(const Surface& surface, const Adjacency& edges, const OpenEdges& open, std::span<const SeamPair> partners,
         RunControl& control)
      : pieces_(surface.face_count()) {
    for_blocks(surface.corners.size(), kItemsPerBlock, control, [&](std::size_t begin, std::size_t end) {
      for (std::size_t h = begin; h < end; ++h) {
        const std::uint32_t twin = edges.twin(static_cast<std::uint32_t>(h));
        if (twin != kNone && twin > h) join(edges, static_cast<std::uint32_t>(h), twin);
      }
    });
    StopCheck check(control);
    for (const EdgeId e : edges.odd_edges()) {
      check();
      if (const auto around = edges.half_edges(e); around.size() == 2) join(edges, around[0], around[1]);
    }
    add(open, partners);
  }

  void add(const OpenEdges& open, std::span<const SeamPair> partners) {
    for (const SeamPair& p : partners) pieces_.join(open[p.i].face.value, open[p.j].face.value);
  }

  bool are_one(FaceId f, FaceId g) { return pieces_.find(f.value) == pieces_.find(g.value); }

 private:
  void join(const Adjacency& edges, std::uint32_t g, std::uint32_t h) {
    pieces_.join(edges.face_of(g).value, edges.face_of(h).value);
  }

  UnionFind pieces_;
};

/// The reasons against a pair, or against several pairs.
struct Doubts {
  int alike = 0, across_pieces = 0, across_labels = 0;
  double behind = 0;  ///< the sum of the angles behind the faces
  double bend = 0;    ///< the sum of the squares of the angles by which the surface bends

  void add(const Doubts& other) {
    alike += other.alike;
    across_pieces += other.across_pieces;
    across_labels += other.across_labels;
    behind += other.behind;
    bend += other.bend;
  }
};

/// Chooses partners for edges that have several candidates.
class Choice {
 public:
  Choice(const Surface& surface, const Adjacency& edges, const OpenEdges& open, std::vector<SeamPair>& chosen,
         RunControl& control)
      : surface_(surface),
        open_(open),
        pieces_(surface, edges, open, chosen, control),
        chosen_(chosen),
        check_(control) {}

  /// Input:  groups of pairs. A group has all pairs of edges that are connected by such pairs.
  void run(std::vector<std::span<const SeamPair>> groups) {
    // Clear choices connect pieces, and this may make other groups clear. The choices in one round do not depend on
    // each other, so the order of the groups does not matter.
    constexpr int kMaxRounds = 4;
    bool is_news = true;
    for (int round = 0; round < kMaxRounds && is_news; ++round) {
      const std::size_t known = chosen_.size();
      std::vector<std::span<const SeamPair>> unclear;
      for (const auto& group : groups)
        if (!choose(group, true)) unclear.push_back(group);
      groups = std::move(unclear);
      pieces_.add(open_, std::span(chosen_).subspan(known));
      is_news = chosen_.size() > known;
    }
    for (const auto& group : groups) choose(group, false);
  }

 private:
  /// For up to this many edges, every possible way to pair them is tried.
  static constexpr std::size_t kFew = 8;
  using Joins = std::vector<std::pair<std::pair<VertexId, VertexId>, std::pair<VertexId, VertexId>>>;

  /// Chooses among the pairs of a group. If `has_to_be_clear`, it decides only if no other choice is about as good.
  /// Output: whether it has decided.
  bool choose(std::span<const SeamPair> pairs, bool has_to_be_clear) {
    pairs_ = pairs;
    nodes_.clear();
    for (const SeamPair& p : pairs) nodes_.insert(nodes_.end(), {p.i, p.j});
    sort_unique(nodes_);
    std::sort(nodes_.begin(), nodes_.end(), [&](std::uint32_t a, std::uint32_t b) {
      check_();
      return open_.is_before(a, b);
    });
    doubts_.clear();
    for (const SeamPair& p : pairs) {
      check_();
      doubts_.push_back(doubts_of(p));
    }
    if (nodes_.size() <= kFew) return choose_best(has_to_be_clear);
    if (has_to_be_clear) return false;
    choose_one_by_one();
    return true;
  }

  Doubts doubts_of(const SeamPair& p) {
    const OpenEdge &a = open_[p.i], &b = open_[p.j];
    const double turn = open_.turn(p.i, p.j);
    return {p.fit.runs_alike, !pieces_.are_one(a.face, b.face), surface_.label(a.face) != surface_.label(b.face),
            open_.angle_behind(p.i, p.j), turn * turn};
  }

  /// The measures by which one way to pair edges is better or worse than other ways.
  struct Rank {
    std::size_t unpaired;
    int alike, across_pieces, across_labels;
    long turns_behind;  ///< number of whole turns by which the sum of its angles exceeds that of the first way
    long bend;          ///< in steps of kBendStep
    double width;

    static constexpr double kBendStep = 0.01;

    auto evidence() const { return std::tuple(unpaired, alike, across_pieces, across_labels, turns_behind); }
    bool is_better_than(const Rank& other) const {
      return std::tuple(evidence(), bend, width) < std::tuple(other.evidence(), other.bend, other.width);
    }
    bool is_clearly_better_than(const Rank& other) const {
      return evidence() < other.evidence() || (evidence() == other.evidence() && bend + 1 < other.bend);
    }
  };

  struct Rival {
    Rank rank;
    std::vector<std::size_t> way;  ///< numbers of pairs
  };

  Rank rank_of(std::span<const std::size_t> pairs) {
    Doubts sum;
    double width = 0;
    for (const std::size_t k : pairs) {
      sum.add(doubts_[k]);
      width += pairs_[k].fit.width;
    }
    const std::size_t unpaired = nodes_.size() - 2 * pairs.size();
    // In all ways that pair all edges, the sums of the angles differ only by whole turns.
    long turns = 0;
    if (unpaired == 0 && sum.alike == 0) {
      if (!behind_) behind_ = sum.behind;
      turns = std::lround((sum.behind - *behind_) / (2 * std::numbers::pi));
    }
    return {unpaired, sum.alike, sum.across_pieces, sum.across_labels, turns, std::lround(sum.bend / Rank::kBendStep),
            width};
  }

  bool choose_best(bool has_to_be_clear) {
    best_.reset();
    behind_.reset();
    rivals_.clear();
    for (auto& row : pair_of_)
      for (std::size_t& pair : row) pair = pairs_.size();
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      const std::size_t a = place_of(pairs_[k].i), b = place_of(pairs_[k].j);
      pair_of_[a][b] = pair_of_[b][a] = k;
    }
    is_taken_.fill(false);
    way_.clear();
    try_from(0, 0);
    if (is_clear()) {
      for (const std::size_t k : best_way_) chosen_.push_back(pairs_[k]);
      return true;
    }
    if (has_to_be_clear || best_->unpaired > 0) return false;
    // This happens, for example, if a surface occurs twice in the same place. With exact coordinates, all these edges
    // would be one edge.
    std::vector<std::size_t> all;
    for (const Rival& rival : rivals_)
      if (!best_->is_clearly_better_than(rival.rank)) all.insert(all.end(), rival.way.begin(), rival.way.end());
    sort_unique(all);
    for (const std::size_t k : all) chosen_.push_back(pairs_[k]);
    return true;
  }

  std::size_t place_of(std::uint32_t node) const {
    return static_cast<std::size_t>(std::find(nodes_.begin(), nodes_.end(), node) - nodes_.begin());
  }

  /// Tries all ways to pair the edges from number k on. Of the edges before k, `left_over` have no partner. The
  /// function recurses at most eight levels deep.
  void try_from(std::size_t k, std::size_t left_over) {
    while (k < nodes_.size() && is_taken_[k]) ++k;
    check_();
    if (k >= nodes_.size()) {
      const Rank rank = rank_of(way_);
      if (!best_ || !best_->is_clearly_better_than(rank)) rivals_.push_back({rank, way_});
      if (best_ && !rank.is_better_than(*best_)) return;
      best_ = rank;
      best_way_ = way_;
      return;
    }
    for (std::size_t other = k + 1; other < nodes_.size(); ++other) {
      if (is_taken_[other] || pair_of_[k][other] == pairs_.size()) continue;
      is_taken_[other] = true;
      way_.push_back(pair_of_[k][other]);
      try_from(k + 1, left_over);
      way_.pop_back();
      is_taken_[other] = false;
    }
    // A way that leaves more edges without a partner than the best one is never better.
    if (!best_ || left_over < best_->unpaired) try_from(k + 1, left_over + 1);
  }

  /// The vertices that these pairs join, in order. Edges with the same ends are the same edge, whichever of its faces
  /// is meant.
  Joins joins_of(std::span<const std::size_t> pairs) const {
    Joins joins;
    for (const std::size_t k : pairs) {
      const auto ends = [&](std::uint32_t node) { return std::minmax(open_[node].from, open_[node].to); };
      const std::pair<VertexId, VertexId> a = ends(pairs_[k].i), b = ends(pairs_[k].j);
      joins.push_back(std::minmax(a, b));
    }
    std::sort(joins.begin(), joins.end());
    return joins;
  }

  /// Returns whether no other result is about as good as the best one.
  bool is_clear() const {
    const Joins joins = joins_of(best_way_);
    return std::all_of(rivals_.begin(), rivals_.end(), [&](const Rival& rival) {
      return best_->is_clearly_better_than(rival.rank) || joins_of(rival.way) == joins;
    });
  }

  /// Takes the best pair of all, then the best of the rest, and so on. Takes none if an edge is left over in the end.
  void choose_one_by_one() {
    std::vector<std::size_t> order(pairs_.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    const auto key = [&](std::size_t k) {
      const Doubts& d = doubts_[k];
      return std::tuple(d.alike, d.across_pieces, d.across_labels, d.alike ? d.bend : d.behind, pairs_[k].fit.width);
    };
    const auto first = [&](const SeamPair& p) { return open_.is_before(p.i, p.j) ? p.i : p.j; };
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      check_();
      if (key(a) != key(b)) return key(a) < key(b);
      return open_.is_before(first(pairs_[a]), first(pairs_[b]));
    });
    std::vector<std::uint32_t> taken;
    const std::size_t before = chosen_.size();
    std::vector<std::uint32_t> sorted = nodes_;
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint8_t> is_taken(sorted.size(), 0);
    const auto mark = [&](std::uint32_t node) -> std::uint8_t& {
      return is_taken[static_cast<std::size_t>(std::lower_bound(sorted.begin(), sorted.end(), node) - sorted.begin())];
    };
    for (const std::size_t k : order) {
      check_();
      std::uint8_t &i = mark(pairs_[k].i), &j = mark(pairs_[k].j);
      if (i || j) continue;
      i = j = 1;
      chosen_.push_back(pairs_[k]);
    }
    if (2 * (chosen_.size() - before) < nodes_.size()) chosen_.resize(before);
  }

  const Surface& surface_;
  const OpenEdges& open_;
  Pieces pieces_;
  std::vector<SeamPair>& chosen_;
  StopCheck check_;
  std::span<const SeamPair> pairs_;
  std::vector<std::uint32_t> nodes_;  ///< the edges, in the order of their places
  std::vector<Doubts> doubts_;        ///< one per pair
  std::array<std::array<std::size_t, kFew>, kFew> pair_of_{};
  std::array<bool, kFew> is_taken_{};
  std::vector<std::size_t> way_, best_way_;
  std::optional<Rank> best_;
  std::optional<double> behind_;  ///< the sum of the angles of the first way that pairs all edges
  std::vector<Rival> rivals_;     ///< the ways that were about as good as the best one so far, including the best one
};

/// Removes the pairs whose edges run the same way and would make a piece one-sided if their ends became one.
void drop_twisting(const Surface& surface, const Adjacency& edges, const OpenEdges& open, std::vector<SeamPair>& pairs,
                   RunControl& control) {
  if (std::none_of(pairs.begin(), pairs.end(), [](const SeamPair& p) { return p.fit.runs_alike; })) return;
  RelativeOrientation orientation(surface.face_count());
  StopCheck check(control);
  for (std::uint32_t e = 0; e < edges.edge_count(); ++e) {
    check();
    const auto around = edges.half_edges(EdgeId(e));
    if (around.size() != 2) continue;
    orientation.join(orientation.of(edges.face_of(around[0])), orientation.of(edges.face_of(around[1])),
                     edges.from(around[0]) == edges.from(around[1]));
  }
  // Pairs that need no face turned over come first, and among equals the long ones.
  sort_stoppable(pairs.begin(), pairs.end(), control, [&](const SeamPair& p, const SeamPair& q) {
    const auto key = [&](const SeamPair& pair) { return std::tuple(pair.fit.runs_alike, -open[pair.i].length); };
    const auto first = [&](const SeamPair& pair) { return open.is_before(pair.i, pair.j) ? pair.i : pair.j; };
    return key(p) != key(q) ? key(p) < key(q) : open.is_before(first(p), first(q));
  });
  const auto is_twisting = [&](const SeamPair& p) {
    check();
    const RelativeOrientation::Side a = orientation.of(open[p.i].face), b = orientation.of(open[p.j].face);
    if (p.fit.runs_alike && a.piece == b.piece && a.is_turned == b.is_turned) return true;
    orientation.join(a, b, p.fit.runs_alike);
    return false;
  };
  std::vector<SeamPair> sound;
  for (const SeamPair& p : pairs)
    if (!is_twisting(p)) sound.push_back(p);
  pairs = std::move(sound);
}

}  // namespace

SeamPartners find_seam_partners(const Surface& surface, const Adjacency& edges, const OpenEdges& open,
                                const SeamRules& rules, RunControl& control) {
  Candidates candidates = find_candidates(open, rules, control);
  SeamPartners found;
  found.is_complete = candidates.is_complete;
  found.is_beside.assign(open.size(), 0);
  if (candidates.pairs.empty()) return found;
  UnionFind groups(open.size());
  std::vector<std::uint32_t> uses(open.size());
  StopCheck check(control);
  for (const SeamPair& p : candidates.pairs) {
    check();
    groups.join(p.i, p.j);
    for (const std::uint32_t k : {p.i, p.j}) {
      found.is_beside[k] = 1;
      ++uses[k];
    }
  }
  std::vector<SeamPair> contested;
  for (const SeamPair& p : candidates.pairs) {
    check();
    (uses[p.i] == 1 && uses[p.j] == 1 ? found.pairs : contested).push_back(p);
  }
  if (!contested.empty()) {
    const auto key = [&](const SeamPair& p) { return std::tuple(groups.find(p.i), p.i, p.j); };
    sort_stoppable(contested.begin(), contested.end(), control,
                   [&](const SeamPair& p, const SeamPair& q) { return key(p) < key(q); });
    std::vector<std::span<const SeamPair>> of_groups;
    for (std::size_t begin = 0, end = 0; begin < contested.size(); begin = end) {
      for (end = begin + 1; end < contested.size() && groups.find(contested[end].i) == groups.find(contested[begin].i);)
        ++end;
      of_groups.push_back(std::span(contested).subspan(begin, end - begin));
    }
    Choice(surface, edges, open, found.pairs, control).run(std::move(of_groups));
  }
  drop_twisting(surface, edges, open, found.pairs, control);
  return found;
}

}  // namespace remesh
