#include "core/patches/chains/chain_sections.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/base/stoppable.h"
#include "core/geometry/triangles/distances.h"

namespace remesh {
namespace {

constexpr double kFullTurn = 2 * std::numbers::pi;

/// Angles and distances are compared with a relative slack, because they are computed with rounding.
constexpr double kSectionSlack = 1e-9;

/// The direction of the turn is clear only if each piece of the input turns by at most this angle.
constexpr double kMaxInputTurn = kFullTurn / 3 * (1 + kSectionSlack);

/// The parts of a piece at which its height over the chord is measured. For circles and ellipses the middle is the
/// highest place; for other sections it is near there.
constexpr std::array kHeightPlaces{0.35, 0.5, 0.65};

/// The max number of pieces of one chain.
constexpr double kMaxPieces = 1 << 20;

double distance_to(const Vec3& p, const Vec3& a, const Vec3& b) { return norm(p - nearest_on_segment(p, a, b)); }

double ratio(double distance, double limit) { return distance > 0 ? distance / limit : 0; }

}  // namespace

double turn_limit(double max_turn) {
  return max_turn <= kFullTurn / 3 * (1 + kSectionSlack) ? max_turn : kFullTurn / 6;
}

std::optional<SectionChain> SectionChain::along(const SectionCurve& curve, std::span<const Vec3> points) {
  SectionChain chain(curve, points);
  double before = curve.angle(points[0]);
  chain.angles_.assign(1, 0);
  for (std::size_t i = 1; i < points.size(); ++i) {
    const double angle = curve.angle(points[i]);
    double turn = angle - before;
    if (turn > kFullTurn / 2) turn -= kFullTurn;
    if (turn < -kFullTurn / 2) turn += kFullTurn;
    if (i == 1) chain.sign_ = turn < 0 ? -1 : 1;
    turn *= chain.sign_;
    if (!(turn > 0) || turn > kMaxInputTurn) return {};
    chain.angles_.push_back(chain.angles_.back() + turn);
    before = angle;
  }
  chain.total_ = chain.angles_.back();
  if (chain.is_closed()) {
    // Every full turn has the same length, whatever the sum of the rounded angles is.
    if (std::fabs(chain.total_ - kFullTurn) > 1e-6) return {};
    chain.total_ = chain.angles_.back() = kFullTurn;
  } else if (chain.total_ >= kFullTurn) {
    return {};
  }
  return chain;
}

double SectionChain::largest_turn() const {
  double largest = 0;
  for (std::size_t i = 0; i < piece_count(); ++i) largest = std::max(largest, angles_[i + 1] - angles_[i]);
  return largest;
}

std::vector<Vec3> SectionChain::divided(std::size_t pieces) const {
  std::vector<Vec3> division;
  division.reserve(pieces + 1);
  division.push_back(points_.front());
  for (std::size_t j = 1; j < pieces; ++j)
    division.push_back(place(static_cast<double>(j) / static_cast<double>(pieces)));
  division.push_back(points_.back());
  return division;
}

/// Measures how far a division is from the curve and from the input.
SectionChain::Misfit SectionChain::misfit(std::span<const Vec3> division, const ChainLimits& limits,
                                          const ChainRoom* room, const RunControl& control) const {
  StopCheck check(control);
  Misfit result;
  const std::size_t pieces = division.size() - 1;
  const auto count = static_cast<double>(pieces);
  const auto note = [&](double distance, double limit) {
    check();
    result.by_length = std::max(result.by_length, ratio(distance, limit));
    result.largest = std::max(result.largest, distance);
  };
  for (std::size_t j = 0; j < pieces; ++j)
    for (const double part : kHeightPlaces) {
      note(distance_to(place((static_cast<double>(j) + part) / count), division[j], division[j + 1]), limits.tolerance);
      const Vec3 on_chord = division[j] + part * (division[j + 1] - division[j]);
      for (const auto& [surface, max_depth] : limits.depths) note(std::fabs(surface->distance(on_chord)), max_depth);
    }
  const auto compare = [&](const Vec3& p, double angle, double limit) {
    const auto j = std::min(pieces - 1, static_cast<std::size_t>(angle / total_ * count));
    note(distance_to(p, division[j], division[j + 1]), limit);
  };
  for (std::size_t i = 1; i < piece_count(); ++i)
    compare(points_[i], angles_[i], room != nullptr ? room->at_node[i] : limits.tolerance);
  // A piece of the input that has a new point inside is compared with this point below.
  if (room != nullptr && pieces <= piece_count())
    for (std::size_t i = 0; i < piece_count(); ++i)
      compare(0.5 * (points_[i] + points_[i + 1]), (angles_[i] + angles_[i + 1]) / 2, room->in_middle[i]);
  std::size_t i = 0;
  for (std::size_t j = 1; j < pieces; ++j) {
    check();
    while (i + 1 < piece_count() && angles_[i + 1] < total_ * (static_cast<double>(j) / count)) ++i;
    const double limit = room != nullptr ? room->in_middle[i] : limits.tolerance;
    if (ratio(distance_to(division[j], points_[i], points_[i + 1]), limit) > 1 + kSectionSlack)
      result.is_off_input = true;
  }
  return result;
}

/// Returns the largest height of the curve over a piece of the input.
double SectionChain::largest_height() const {
  double largest = 0;
  for (std::size_t i = 0; i < piece_count(); ++i)
    largest = std::max(largest, distance_to(middle(i), points_[i], points_[i + 1]));
  return largest;
}

bool SectionChain::are_pieces_even(std::span<const Vec3> division, double fit_tolerance) const {
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (!(norm(division[i] - points_[i]) <= fit_tolerance)) return false;
  return true;
}

/// Returns the nodes at the inner points of a division. If any inner point has no node, the result is empty.
std::vector<std::uint32_t> SectionChain::nodes_at(std::span<const Vec3> division, double fit_tolerance) const {
  std::vector<std::uint32_t> nodes;
  std::size_t i = 1;
  for (std::size_t j = 1; j + 1 < division.size(); ++j) {
    while (i + 1 < points_.size() && norm(division[j] - points_[i]) > fit_tolerance) ++i;
    if (i + 1 == points_.size()) return {};
    nodes.push_back(static_cast<std::uint32_t>(i++));
  }
  return nodes;
}

SectionChain::Division SectionChain::divide(const ChainLimits& limits, double fit_tolerance,
                                            const std::function<ChainRoom(double)>& room,
                                            const RunControl& control) const {
  Division result;
  const double turn = turn_limit(limits.max_turn), wanted = std::ceil(total_ / turn * (1 - kSectionSlack));
  if (!(wanted <= kMaxPieces)) return result;
  const std::size_t of_input = piece_count();
  const std::size_t by_turn = std::max(static_cast<std::size_t>(is_closed() ? 3 : 1), static_cast<std::size_t>(wanted));
  const std::size_t first =
      std::max(by_turn, static_cast<std::size_t>(std::min(limits.min_pieces, static_cast<double>(of_input))));
  const bool may_stay = turn >= largest_turn() * (1 - kSectionSlack);
  const std::size_t max = may_stay ? of_input - 1 : std::max(first, of_input);
  std::optional<ChainRoom> known;
  std::size_t without_room = 0;  // the number of pieces that would do if no other boundary were near
  std::size_t n = first;
  for (int tries = 0; n <= max && !result.is_changed;) {
    control.check();
    const std::vector<Vec3> division = divided(n);
    if (n == of_input && are_pieces_even(division, fit_tolerance)) break;
    const Misfit found = misfit(division, limits, known ? &*known : nullptr, control);
    if (found.is_off_input || !(found.by_length < kMaxPieces)) break;
    if (found.by_length > 1 + kSectionSlack) {
      // Heights shrink with the square of the length. The estimate is never above the min number of pieces of a circle.
      // After some tries the steps grow, so that the work stays in proportion.
      const double estimate = static_cast<double>(n) * std::sqrt(found.by_length) * (tries++ < 8 ? 0.999 : 1.1);
      if (!(estimate <= kMaxPieces)) break;
      n = std::max(n + 1, static_cast<std::size_t>(std::ceil(estimate)));
    } else if (!known) {
      without_room = n;
      // No distance from the input is larger than this, neither now nor with more pieces.
      known = room(std::min(limits.tolerance, std::max(found.largest, largest_height()) * (1 + kSectionSlack)));
      if (!known->is_limited) take(division, fit_tolerance, result);
    } else {
      take(division, fit_tolerance, result);
    }
  }
  result.is_limited = known && known->is_limited && (!result.is_changed || n != without_room);
  result.is_limited = result.is_limited || (result.is_changed && first > by_turn);
  return result;
}

void SectionChain::take(std::span<const Vec3> division, double fit_tolerance, Division& result) const {
  result.is_changed = true;
  result.kept = nodes_at(division, fit_tolerance);
  if (result.kept.empty()) result.points.assign(division.begin() + 1, division.end() - 1);
}

}  // namespace remesh
