#include "server/jobs/job_store.h"

#include <algorithm>
#include <array>
#include <utility>

namespace remesh::server::jobs {
namespace {

constexpr std::array<std::pair<JobState, std::string_view>, 6> kNames{{{JobState::kQueued, "queued"},
                                                                       {JobState::kRunning, "running"},
                                                                       {JobState::kSucceeded, "succeeded"},
                                                                       {JobState::kFailed, "failed"},
                                                                       {JobState::kCancelled, "cancelled"},
                                                                       {JobState::kExpired, "expired"}}};

}  // namespace

std::string_view state_name(JobState state) {
  return std::find_if(kNames.begin(), kNames.end(), [&](const auto& entry) { return entry.first == state; })->second;
}

std::optional<JobState> state_from_name(std::string_view name) {
  const auto found =
      std::find_if(kNames.begin(), kNames.end(), [&](const auto& entry) { return entry.second == name; });
  return found == kNames.end() ? std::nullopt : std::optional(found->first);
}

}  // namespace remesh::server::jobs
