/// Tells in words what attempts have shown, and what was decided after them.
#pragma once

#include <optional>
#include <string>

#include "core/output/run/decisions.h"
#include "core/output/run/outcome.h"

namespace remesh {

/// Returns in words what is decided differently in `next`; empty if nothing is.
std::string difference(const Decisions& now, const Decisions& next);

/// Returns what an attempt has shown, and what the next one does otherwise, in one line.
/// Input: the decisions for the attempt and for the next one, if there is one; `number` counts attempts from 1.
std::string line_of_trace(int number, const Decisions& now, const Outcome& outcome,
                          const std::optional<Decisions>& next);

}  // namespace remesh
