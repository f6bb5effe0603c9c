/// Decides what is tried next. This is the only place that knows it, and there is no geometry here.
#pragma once

#include <optional>

#include "core/output/run/decisions.h"
#include "core/output/run/outcome.h"
#include "core/refinement/attempts/refinement_choices.h"

namespace remesh {

/// Returns the decisions for the next attempt. There are none if the last one is the answer, or if nothing is left that
/// could be tried: then the end of `outcome` is not kVerified.
/// Holds:  rungs only rise, and floors, budgets, marks and limits change only so often. So an answer or a failure comes
///         after a bounded number of attempts.
/// Source: rules.md, Ladder; rules.md, Budget.
std::optional<Decisions> learn(const Decisions& now, const Outcome& outcome, const Effort& effort);

/// Adds what an attempt took to what those before it took.
/// Input: `now` is what was decided for the attempt.
Effort spent(const Effort& before, const Decisions& now, const Outcome& outcome);

/// Returns the work that counts after the input was mended anew.
Effort for_another_surface(const Effort& before);

}  // namespace remesh
