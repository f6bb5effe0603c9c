#include "core/output/run/decisions.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/base/number_text.h"

namespace remesh {
namespace {

std::size_t count(const FaceMarks& marks) {
  return marks.size() - static_cast<std::size_t>(std::count(marks.begin(), marks.end(), 0));
}

/// Returns how many input faces have another value. A shorter list stands for faces without any.
template <class T>
std::size_t count_different(const std::vector<T>& a, const std::vector<T>& b) {
  std::size_t different = 0;
  for (std::size_t i = 0; i < std::max(a.size(), b.size()); ++i)
    different += (i < a.size() ? a[i] : T()) != (i < b.size() ? b[i] : T()) ? 1 : 0;
  return different;
}

/// Collects what is different, separated by commas.
class Differences {
 public:
  void add(const std::string& what) { text_ += (text_.empty() ? "" : ", ") + what; }
  void add_faces(std::size_t faces, const std::string& what) {
    if (faces > 0) add(std::to_string(faces) + " input faces " + what);
  }
  std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

void compare_curved(const CurvedChoices& now, const CurvedChoices& next, Differences& found) {
  if (next.are_all_facets && !now.are_all_facets) found.add("no facets are joined any more");
  const auto name = [](CurvedRung rung) -> std::string {
    switch (rung) {
      case CurvedRung::kJoined: return "are joined again";
      case CurvedRung::kTightened: return "are joined within finer limits";
      case CurvedRung::kCoarser: return "stay facets because these are coarser";
      case CurvedRung::kFacet: return "become facets";
    }
    return "";
  };
  for (const CurvedRung rung :
       {CurvedRung::kJoined, CurvedRung::kTightened, CurvedRung::kCoarser, CurvedRung::kFacet}) {
    std::size_t faces = 0;
    for (std::size_t f = 0; f < next.rung.size(); ++f) {
      const CurvedRung before = f < now.rung.size() ? now.rung[f] : CurvedRung::kJoined;
      faces += next.rung[f] == rung && before != rung ? 1 : 0;
    }
    found.add_faces(faces, name(rung));
  }
  if (next.offsets.left.size() > now.offsets.left.size())
    found.add(std::to_string(next.offsets.left.size() - now.offsets.left.size()) + " surfaces are not moved outwards");
  if (next.offsets.corrections > now.offsets.corrections) found.add("surfaces are moved outwards by better offsets");
}

void compare_refinement(const RefinementChoices& now, const RefinementChoices& next, Differences& found) {
  if (next.min_edge.min_edge_length() != now.min_edge.min_edge_length())
    found.add("min_edge_length is " + number_text(next.min_edge.min_edge_length()));
  if (next.coarsest != now.coarsest) found.add("gaps ask for no size below " + number_text(next.coarsest));
  if (next.has_budget && !now.has_budget) found.add("the faces get a budget");
  if (next.budget != now.budget && next.budget) found.add("the budget is " + std::to_string(*next.budget) + " faces");
  if (next.part != now.part) {
    switch (next.part) {
      case RefinedPart::kAll: found.add("all is refined"); break;
      case RefinedPart::kNothingYet: found.add("nothing is refined until a result passes"); break;
      case RefinedPart::kRest: found.add("what has never failed is refined"); break;
      case RefinedPart::kGivenUp: found.add("nothing is refined"); break;
    }
  }
  if (const std::size_t before = count(now.frozen), after = count(next.frozen); after > before)
    found.add_faces(after - before, "stay unrefined");
  else if (after < before)
    found.add_faces(before - after, "may be refined again");
}

}  // namespace

std::string difference(const Decisions& now, const Decisions& next) {
  Differences found;
  found.add_faces(count_different(now.mending.keep_verbatim, next.mending.keep_verbatim), "are copied verbatim");
  if (now.mending.is_joining_allowed && !next.mending.is_joining_allowed) found.add("mending joins nothing");
  if (!(now.mending == next.mending)) {
    found.add("all else begins anew");
    return std::move(found).text();
  }
  if (next.details.replaced.size() > now.details.replaced.size()) {
    found.add("the surface without these details is divided");
    return std::move(found).text();
  }
  found.add_faces(count_different(now.rungs.zone, next.rungs.zone), "are divided by a tighter tolerance");
  compare_curved(now.curved, next.curved, found);
  compare_refinement(now.refinement, next.refinement, found);
  return std::move(found).text();
}

}  // namespace remesh
