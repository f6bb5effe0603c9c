#include "core/output/report/face_count_explanation.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "core/base/number_text.h"
#include "core/output/report/surface_words.h"
#include "core/refinement/attempts/refinement_choices.h"

namespace remesh {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// An option is worth telling if it leaves at most this share of the faces.
constexpr double kWorthTelling = 0.8;
/// A value is no better than the one before it if it leaves more than this share of that one's faces.
constexpr double kNoGain = 0.97;
/// No value of an option is tried after this many steps.
constexpr int kMaxSteps = 10;
/// Values of options are tried as long as all predictions together have looked at sizes at fewer places than this.
/// Where sizes vary, a prediction looks at some kPlacesPerTriangle in each triangle. Where they do not, it takes no
/// longer than a look at a place for each kTrianglesPerPlace triangles. Sizes that are found anew take as long again.
constexpr std::uint64_t kMaxPlaces = std::uint64_t{1} << 19, kPlacesPerTriangle = 64, kTrianglesPerPlace = 8;
/// A floor that is suggested is at most this fraction of the diagonal, and the first one that is tried this one.
constexpr double kHighestFloor = 0x1p-6, kLowestMinEdge = 0x1p-20;

/// Formats a value of an option.
std::string value_text(double value) { return number_text(value, 3); }

/// Rounds a value to three digits, so that the value that is told is the one that was tried.
double with_three_digits(double value) {
  if (!(value > 0) || !std::isfinite(value)) return value;
  const std::string text = value_text(value);
  double read = value;
  std::from_chars(text.data(), text.data() + text.size(), read);
  return read;
}

std::string whole_text(double faces) { return grouped_digits(static_cast<std::uint64_t>(std::min(faces, 0x1p62))); }

/// A value of an option, and the number of faces that are predicted with it.
struct TriedValue {
  std::string option;  ///< with its value
  double faces;
};

class Explanation {
 public:
  explicit Explanation(const FacesToExplain& result)
      : result_(result),
        first_goals_(result.goals),
        lowest_floor_(std::max(min_edge_of_details(result.options, result.goals), result.goals.min_edge_of_storage)) {
    faces_of_patch_.reserve(result.patches.count());
    for (std::size_t p = 0; p < result.patches.count(); ++p) {
      faces_of_patch_.push_back(result.faces.of_patch(PatchId(p)));
      faces_ += faces_of_patch_.back();
    }
    allowed_ = has_target() ? (1 + kOffTarget) * static_cast<double>(*result.options.target_faces)
                            : std::max(kFewFacesAlways, kTimesOfInput * static_cast<double>(result.input_triangles));
    max_worth_telling_ = kWorthTelling * faces_;
  }

  bool are_many() const { return faces_ > allowed_; }
  bool is_floor_found() const {
    return !result_.options.min_edge_length && result_.goals.min_edge_length > lowest_floor_;
  }

  Diagnostic diagnostic() {
    Diagnostic warning{DiagnosticCode::kManyFaces, 0, {}, ""};
    const std::size_t patches = add_largest_patches(warning);
    const double predicted = predict(result_.goals);
    scale_ = predicted > 0 ? faces_ / predicted : 1;
    const Cause cause = find_cause(predicted);
    warning.message = (is_counted() ? "the result has " + whole_text(faces_) : about(faces_) + " faces are expected,") +
                      (is_counted() ? " faces, " : " ") +
                      value_text(faces_ / static_cast<double>(std::max<std::uint64_t>(result_.input_triangles, 1))) +
                      " times the input's " + grouped_digits(result_.input_triangles) + " triangles, mostly because " +
                      cause_text(cause) + "; half of them are in " +
                      (patches == 1 ? "1 patch" : grouped_digits(patches) + " patches");
    if (is_floor_found()) warning.message += floor_text();
    if (has_target()) warning.message += target_text();
    std::vector<TriedValue> remedies = are_many() ? find_remedies(cause) : find_remedies_without_floor();
    for (std::size_t i = 0; i < remedies.size(); ++i)
      warning.message += (i == 0                     ? "; "
                          : i + 1 == remedies.size() ? " and "
                                                     : ", ") +
                         remedies[i].option + (i == 0 ? " would give " : " ") + about(remedies[i].faces) +
                         (i == 0 ? are_many() ? " faces" : " faces without a floor" : "");
    std::stable_sort(remedies.begin(), remedies.end(),
                     [](const TriedValue& a, const TriedValue& b) { return a.faces < b.faces; });
    for (TriedValue& tried : remedies)
      warning.remedies.push_back({std::move(tried.option), "would give " + about(tried.faces) + " faces"});
    return warning;
  }

 private:
  enum class Cause { kSizes, kGaps, kAngles, kCircles };

  bool is_counted() const { return result_.faces.are == RefinedFaces::Are::kCounted; }

  /// Adds the input's faces of the patches with the largest shares.
  /// Output: the number of these patches.
  std::size_t add_largest_patches(Diagnostic& warning) const {
    std::vector<PatchId> largest;
    largest.reserve(faces_of_patch_.size());
    for (std::size_t p = 0; p < faces_of_patch_.size(); ++p) largest.push_back(PatchId(p));
    std::stable_sort(largest.begin(), largest.end(),
                     [&](PatchId a, PatchId b) { return faces_of_patch_[a.value] > faces_of_patch_[b.value]; });
    double sum = 0;
    std::vector<FaceId> faces;
    std::size_t count = 0;
    for (; count < largest.size() && sum < faces_ / 2; ++count) {
      sum += faces_of_patch_[largest[count].value];
      const auto of_patch = result_.patches.faces_of(largest[count]);
      faces.insert(faces.end(), of_patch.begin(), of_patch.end());
    }
    std::sort(faces.begin(), faces.end());
    result_.surface.for_each_source(faces, [&](FaceId source) { warning.add(source.value); });
    return count;
  }

  bool are_sizes_asked() const {
    return std::isfinite(result_.goals.max_edge_length) || std::isfinite(result_.goals.max_area);
  }

  /// Predicts the faces of a result, and counts the places at which this looks at sizes.
  double predict(const Goals& goals) {
    const std::uint64_t triangles = result_.input_triangles;
    const bool do_sizes_vary = goals.proximity > 0 || goals.gradation > 0;
    const bool are_sizes_found_anew =
        goals.proximity != result_.goals.proximity || goals.max_edge_length != result_.goals.max_edge_length;
    places_ += do_sizes_vary ? (are_sizes_found_anew ? 2 : 1) * kPlacesPerTriangle * triangles
                             : 1 + triangles / kTrianglesPerPlace;
    return result_.predict(goals);
  }

  /// Returns the goal without which the fewest faces are predicted.
  /// Input: the number of faces that is predicted with all goals.
  Cause find_cause(double predicted) {
    Cause cause = is_curved_resolution_given(result_.options) ? Cause::kCircles : Cause::kAngles;
    double fewest = kNoGain * predicted;
    const auto try_without = [&](Cause candidate, const Goals& goals) {
      const double faces = predict(goals);
      if (!(faces < fewest)) return;
      fewest = faces;
      cause = candidate;
    };
    if (are_sizes_asked()) {
      Goals goals = result_.goals;
      goals.max_edge_length = goals.max_area = kInfinity;
      try_without(Cause::kSizes, goals);
    }
    if (result_.goals.proximity > 0 || result_.goals.gradation > 0) {
      Goals goals = result_.goals;
      goals.proximity = goals.gradation = 0;
      try_without(Cause::kGaps, goals);
    }
    if (result_.goals.min_angle_deg > 0) {
      Goals goals = result_.goals;
      goals.min_angle_deg = 0;
      try_without(Cause::kAngles, goals);
    }
    return cause;
  }

  std::string cause_text(Cause cause) const {
    switch (cause) {
      case Cause::kSizes:
        return std::isfinite(result_.goals.max_edge_length) ? "of the largest edge that was asked for"
                                                            : "of the largest area that was asked for";
      case Cause::kGaps:
        return result_.goals.proximity > 0 ? "proximity asks for small edges at narrow gaps"
                                           : "gradation asks for small edges around short ones";
      case Cause::kCircles: return "curved surfaces were divided as finely as was asked for";
      case Cause::kAngles: break;
    }
    double curved = 0;
    for (std::size_t p = 0; p < faces_of_patch_.size(); ++p)
      if (result_.is_curved_facet(PatchId(p))) curved += faces_of_patch_[p];
    if (2 * curved > faces_) return "the facets of curved surfaces are narrow, and the bound on angles divides them";
    return "the bound on angles divides needles and what is beside small angles or short edges of the input";
  }

  bool has_target() const { return result_.options.target_faces.has_value(); }

  /// Tells how many faces there are without any largest edge.
  std::string target_text() {
    Goals goals = result_.goals;
    goals.max_edge_length = kInfinity;
    const bool is_least = std::isinf(result_.goals.max_edge_length);
    return "; target_faces=" + std::to_string(*result_.options.target_faces) +
           " is not met: the other options alone need " + (is_least ? whole_text(faces_) : about(faces_with(goals))) +
           " faces";
  }

  /// Tells of the floor that was found.
  std::string floor_text() {
    Goals goals = result_.goals;
    goals.min_edge_length = 0;
    const double predicted = predict(goals);
    const auto proportion = static_cast<double>(goals.faces_without_min_edge);
    // The floor was looked for because more than these are made or predicted without it.
    const std::string without = predicted > proportion ? about(predicted) : "more than " + whole_text(proportion);
    std::string text = "; min_edge_length=auto has found the floor " + value_text(result_.goals.min_edge_length);
    if (is_counted())
      text += ", which left " + grouped_digits(result_.left_by_min_edge) + " triangles below the bound (size_floor)";
    return text + "; min_edge_length=0 would give " + without + " faces";
  }

  /// Predicts the faces of a result with other goals.
  double faces_with(Goals goals) {
    // A floor would be found again, and it could be lower.
    const bool is_automatic = is_floor_found() && goals.min_edge_length == result_.goals.min_edge_length;
    if (is_automatic) goals.min_edge_length = 0;
    const double faces = predict(goals);
    const auto proportion = static_cast<double>(goals.faces_without_min_edge);
    if (is_automatic && faces > proportion) return proportion;
    return std::max(scale_ * faces, static_cast<double>(result_.patches.count()));
  }

  /// Goes through the values of one option until there are few faces.
  /// Input: `next` sets the next value in the goals, and returns how it is asked for; empty: there are no more.
  template <class Next>
  void try_values(const Next& next) {
    std::optional<TriedValue> best;
    Goals goals = first_goals_;
    for (int step = 0; step < kMaxSteps && places_ < kMaxPlaces; ++step) {
      const std::string option = next(goals, step);
      if (option.empty()) break;
      const double faces = faces_with(goals);
      if (best && !(faces < kNoGain * best->faces)) break;
      best = {option, faces};
      if (faces <= allowed_) break;
    }
    if (best && best->faces <= max_worth_telling_) remedies_.push_back(*std::move(best));
  }

  std::vector<TriedValue> find_remedies(Cause cause) {
    if (cause == Cause::kSizes) try_sizes();
    if (cause == Cause::kGaps) try_gaps();
    try_circles();
    if (cause != Cause::kSizes && are_sizes_asked()) try_sizes();
    if (cause != Cause::kGaps) try_gaps();
    if (cause == Cause::kAngles) {
      try_angles();
      try_floors();
    }
    return std::move(remedies_);
  }

  /// Finds the values of options with which a floor would not even be looked for.
  std::vector<TriedValue> find_remedies_without_floor() {
    first_goals_.min_edge_length = lowest_floor_;
    scale_ = 1;
    allowed_ = max_worth_telling_ = static_cast<double>(result_.goals.faces_without_min_edge);
    try_circles();
    try_angles();
    return std::move(remedies_);
  }

  void try_sizes() {
    if (std::isfinite(result_.goals.max_edge_length) && !is_target_given(result_.options))
      try_values([&](Goals& goals, int) -> std::string {
        const double of_one = result_.options.max_edge_fraction ? result_.diagonal : 1;
        const double value = with_three_digits(2 * goals.max_edge_length / of_one);
        goals.max_edge_length = value * of_one;
        if (goals.max_edge_length > 2 * result_.diagonal) return "";
        return (result_.options.max_edge_fraction ? "max_edge_fraction=" : "max_edge_length=") + value_text(value);
      });
    if (std::isfinite(result_.goals.max_area))
      try_values([&](Goals& goals, int) -> std::string {
        goals.max_area = with_three_digits(4 * goals.max_area);
        if (goals.max_area > result_.diagonal * result_.diagonal) return "";
        return "max_area=" + value_text(goals.max_area);
      });
  }

  void try_gaps() {
    if (!(result_.goals.proximity > 0)) return;
    try_values([&](Goals& goals, int step) -> std::string {
      constexpr int kHalvings = 2;
      if (step > kHalvings) return "";
      goals.proximity = step < kHalvings ? with_three_digits(goals.proximity / 2) : 0;
      if (goals.proximity == 0 && !result_.options.gradation) goals.gradation = 0;
      return "proximity=" + value_text(goals.proximity);
    });
  }

  void try_angles() {
    constexpr std::array kDegrees{20.0, 15.0, 10.0};
    std::size_t i = 0;
    while (i < kDegrees.size() && kDegrees[i] >= result_.goals.min_angle_deg) ++i;
    try_values([&](Goals& goals, int) -> std::string {
      if (i == kDegrees.size()) return "";
      goals.min_angle_deg = kDegrees[i++];
      return "min_angle_deg=" + value_text(goals.min_angle_deg);
    });
  }

  void try_floors() {
    try_values([&](Goals& goals, int) -> std::string {
      goals.min_edge_length =
          with_three_digits(goals.min_edge_length > 0 ? 4 * goals.min_edge_length : kLowestMinEdge * result_.diagonal);
      if (goals.min_edge_length > kHighestFloor * result_.diagonal) return "";
      return "min_edge_length=" + value_text(goals.min_edge_length);
    });
  }

  void try_circles() {
    std::optional<TriedValue> best;
    const std::map<int, std::uint64_t> by_number = result_.predict_by_circles();
    for (auto of = by_number.rbegin(); of != by_number.rend(); ++of) {
      if (result_.options.elements_per_circle && of->first >= *result_.options.elements_per_circle) continue;
      best = {"elements_per_circle=" + std::to_string(of->first), static_cast<double>(of->second)};
      if (best->faces <= allowed_) break;
    }
    if (best && best->faces <= max_worth_telling_) remedies_.push_back(*std::move(best));
  }

  const FacesToExplain& result_;
  Goals first_goals_;    ///< the goals from which values of options are tried
  double lowest_floor_;  ///< the floor, unless a higher one was found
  std::vector<double> faces_of_patch_;
  double faces_ = 0;
  double allowed_ = 0;
  double scale_ = 1;  ///< the faces there are over those that are predicted
  double max_worth_telling_ = 0;
  std::uint64_t places_ = 0;  ///< the number of places at which predictions have looked at sizes
  std::vector<TriedValue> remedies_;
};

}  // namespace

void explain_face_count(const FacesToExplain& result, std::vector<Diagnostic>& diagnostics) {
  Explanation explanation(result);
  if (explanation.are_many() || explanation.is_floor_found()) diagnostics.push_back(explanation.diagnostic());
}

}  // namespace remesh
