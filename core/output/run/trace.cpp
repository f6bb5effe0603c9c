#include "core/output/run/trace.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "core/base/number_text.h"

namespace remesh {
namespace {

std::size_t count(const FaceMarks& marks) {
  return marks.size() - static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 0));
}

/// Returns how many input faces have different values in two lists. Faces beyond the end of a list have the value T().
template <class T>
std::size_t count_different(const std::vector<T>& a, const std::vector<T>& b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i)
    different += (i < a.size() ? a[i] : T()) != (i < b.size() ? b[i] : T()) ? 1 : 0;
  return different;
}

std::string counted(std::size_t count, const std::string& one, const std::string& more) {
  return std::to_string(count) + " " + (count == 1 ? one : more);
}
std::string input_faces(std::size_t count) { return counted(count, "input face", "input faces"); }
std::string whole(double faces) { return std::to_string(static_cast<std::uint64_t>(std::min(faces, 1e15))); }

/// Collects what is different, separated by commas.
class Differences {
 public:
  void add(const std::string& what) { text_ += (text_.empty() ? "" : ", ") + what; }
  void add_faces(const std::string& before, std::size_t faces, const std::string& after) {
    if (faces > 0) add(before + " " + input_faces(faces) + after);
  }
  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

void compare_curved(const CurvedChoices& now, const CurvedChoices& next, Differences& found) {
  if (next.are_all_facets && !now.are_all_facets) found.add("keep all curved surfaces as flat facets");
  const auto changed_to = [&](CurvedRung rung) {
    std::size_t faces = 0;
    for (std::size_t f = 0; f < next.rung.size(); ++f) {
      const CurvedRung before = f < now.rung.size() ? now.rung[f] : CurvedRung::kJoined;
      faces += next.rung[f] == rung && before != rung ? 1 : 0;
    }
    return faces;
  };
  found.add_faces("remesh", changed_to(CurvedRung::kJoined), " as curved surfaces, as before");
  found.add_faces("remesh", changed_to(CurvedRung::kTightened), " of curved surfaces more finely");
  found.add_faces("keep", changed_to(CurvedRung::kCoarser) + changed_to(CurvedRung::kFacet), " as flat facets");
  if (const std::size_t left = next.offsets.left.size() - now.offsets.left.size(); left > 0)
    found.add("do not move " + counted(left, "curved surface", "curved surfaces") + " outwards");
  if (next.offsets.corrections > now.offsets.corrections)
    found.add("correct the offsets of curved surfaces (round " + std::to_string(next.offsets.corrections) + ")");
}

void compare_refinement(const RefinementChoices& now, const RefinementChoices& next, Differences& found) {
  if (next.min_edge.min_edge_length() != now.min_edge.min_edge_length())
    found.add((next.min_edge.min_edge_length() > now.min_edge.min_edge_length() ? "raise" : "lower") +
              std::string(" min_edge_length to ") + number_text(next.min_edge.min_edge_length()));
  if (next.target != now.target) found.add("choose the largest edge anew for the target");
  if (next.coarsest != now.coarsest) found.add("no edges below " + number_text(next.coarsest) + " because of gaps");
  if (next.budget && next.budget != now.budget)
    found.add(*next.budget == Goals::kNoLimit
                  ? "thin out quickly"
                  : "stop refining at " + std::to_string(*next.budget) + " faces, apart from edges that must be cut");
  if (next.part != now.part) {
    switch (next.part) {
      case RefinedPart::kAll: found.add("refine everything"); break;
      case RefinedPart::kNothingYet: found.add("refine nothing until a result is verified"); break;
      case RefinedPart::kRest: found.add("refine what has never failed"); break;
      case RefinedPart::kGivenUp: found.add("refine nothing"); break;
    }
  }
  const std::size_t before = count(now.frozen), after = count(next.frozen);
  if (after > before) found.add_faces("insert no points into", after - before, "");
  if (after < before) found.add_faces("insert points into", before - after, " after all");
}

std::string about_faces(const Decisions& now, const Outcome& outcome) {
  const RefinementFacts& facts = outcome.facts;
  const std::string limit = std::to_string(facts.expected_limit());
  const std::string allowed =
      facts.is_min_edge_automatic ? limit + " are in proportion to the input" : limit + " are allowed";
  switch (outcome.end) {
    case Outcome::End::kMinEdgeTooShort:
      return "refinement was not begun: about " + whole(facts.predicted) + " faces are predicted, at most " + allowed;
    case Outcome::End::kTooManyMade:
      if (facts.max_faces == Goals::kNoLimit && !facts.is_min_edge_automatic) return "the number of faces has no limit";
      if (facts.predicted <= static_cast<double>(facts.expected_limit()))
        return "refinement was stopped: more faces were made than the " + limit +
               (facts.is_min_edge_automatic ? " that are in proportion to the input" : " that are allowed") +
               "; about " + whole(facts.predicted) + " had been predicted";
      return "refinement was stopped: about " + whole(facts.predicted) + " faces are predicted, at most " + allowed;
    case Outcome::End::kGapsTooFine:
      return "narrow gaps would need far more faces than the " + limit + " that are allowed";
    default: break;
  }
  const std::string faces = std::to_string(outcome.faces.value_or(0)) + " faces";
  if (is_off_target(facts)) return faces + ", " + number_text(*facts.over_target, 3) + " times the target";
  if (*outcome.faces > facts.expected_limit()) return faces + ", at most " + allowed;
  if (outcome.are_angles_worse) return faces + ", but the smallest angles are smaller than before refinement";
  if (!now.refinement.budget && facts.is_min_edge_automatic)
    return faces + ", acceptable and not checked yet, since a smaller min_edge_length may meet more bounds";
  return faces + ", at most " + allowed;
}

std::string about_failures(const Outcome& outcome) {
  std::string text = outcome.end == Outcome::End::kPatchesFailed
                         ? counted(outcome.failed.size(), "patch", "patches") + " could not be triangulated (" +
                               std::string(reason_name(outcome.failed.front().reason)) + ")"
                     : outcome.is_whole_wrong
                         ? "verification failed for the result as a whole: " + outcome.reason
                         : "verification failed at " + counted(outcome.failed.size(), "patch", "patches") +
                               (outcome.failed.size() > 1 ? ", the first failure: " : ": ") + outcome.reason;
  if (!outcome.faults.empty())
    text += "; the cause may be " + counted(outcome.faults.size(), "curved patch", "curved patches") +
            " at these patches or beside them";
  return text;
}

std::string about_result(const Decisions& now, const Outcome& outcome) {
  std::string text = "verified, " + counted(outcome.faces.value_or(0), "face", "faces");
  if (const MinEdgeSearch& min_edge = now.refinement.min_edge; min_edge.min_edge_length() > min_edge.asked())
    text += ", min_edge_length " + number_text(min_edge.min_edge_length());
  if (const std::size_t frozen = count(now.refinement.frozen); frozen > 0)
    text += ", " + input_faces(frozen) + " without new points";
  return text;
}

std::string shown(const Decisions& now, const Outcome& outcome) {
  switch (outcome.end) {
    case Outcome::End::kSurfaceReplaced:
      if (outcome.is_arranged) return "faces were cut along their intersections";
      return outcome.is_coarsened ? "the surface was made coarser" : "details were removed";
    case Outcome::End::kNothingCut: return "no faces were cut";
    case Outcome::End::kPatchesFailed:
    case Outcome::End::kCheckFailed: return about_failures(outcome);
    case Outcome::End::kWorkInVain: return "too much work was spent on results that failed verification";
    case Outcome::End::kFacetsCoarser:
      return outcome.compared.coarser.empty()
                 ? "facets that were kept flat need more faces than curved patches needed there before"
                 : "in some places, flat facets are expected to need fewer faces than curved patches do";
    case Outcome::End::kOffsetsImpossible: return "curved patches have too few vertices that may move to keep volumes";
    case Outcome::End::kOffsetsChanged:
      return "the offsets of curved surfaces do not keep their volumes closely enough";
    case Outcome::End::kVerified: return about_result(now, outcome);
    default: return about_faces(now, outcome);
  }
}

}  // namespace

std::string difference(const Decisions& now, const Decisions& next) {
  Differences found;
  found.add_faces("copy", count_different(now.mending.keep_verbatim, next.mending.keep_verbatim), " as they are");
  if (now.mending.is_joining_allowed && !next.mending.is_joining_allowed) found.add("mend without joining anything");
  if (!(now.mending == next.mending)) {
    found.add("begin anew");
    return std::move(found).text();
  }
  if (now.rungs.are_any() && !next.rungs.are_any() && now.details.arranged == next.details.arranged &&
      now.details.replaced == next.details.replaced)
    return "begin again with whole patches, and make the surface coarser first";
  if (next.details.arranged && !now.details.arranged) return "divide the faces that were cut";
  if (next.details.is_coarsened && !now.details.is_coarsened) return "divide the coarser surface";
  if (next.details.replaced.size() > now.details.replaced.size()) return "divide the surface without them";
  found.add_faces("divide", count_different(now.rungs.zone, next.rungs.zone),
                  " into smaller patches (step " + std::to_string(next.rungs.steps) + ")");
  compare_curved(now.curved, next.curved, found);
  compare_refinement(now.refinement, next.refinement, found);
  return std::move(found).text();
}

std::string line_of_trace(int number, const Decisions& now, const Outcome& outcome,
                          const std::optional<Decisions>& next) {
  const std::string line = "attempt " + std::to_string(number) + ": " + shown(now, outcome);
  if (next) return line + " -> next: " + difference(now, *next);
  return line + (outcome.end == Outcome::End::kVerified ? "" : " -> nothing is left to be tried");
}

}  // namespace remesh
