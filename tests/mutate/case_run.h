/// Runs one case in the calling process.
#pragma once

#include <string>
#include <vector>

#include "tests/mutate/case_source.h"
#include "tests/mutate/judge.h"
#include "tests/mutate/timed_run.h"

namespace remesh::mutate {

struct TryLimits {
  double time_s = 20;      ///< a run that takes longer is stopped
  double busy_s = 10;      ///< a run that takes more processor time is a finding
  double stop_ms = 200;    ///< longest time that a run may live after a stop
  double patience_s = 60;  ///< after this time since a stop, a run counts as one that never ends
  std::uint64_t max_faces = 200'000;
};

/// The result of a case.
struct CaseResult {
  std::string outcome;  ///< `accepted`, `refused: CODE`, `stopped`, `slow`, `out_of_memory`
  double seconds = 0;
  std::vector<Objection> findings;
  double stop_busy_ms = 0;  ///< processor time from the stop to the end, for a stopped run
};

CaseResult try_case(const Case& c, const TryLimits& limits);

}  // namespace remesh::mutate
