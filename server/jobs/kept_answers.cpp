#include "server/jobs/kept_answers.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "server/work/memory_wait.h"

namespace remesh::server::jobs {
namespace {

/// Answers are kept for this long after they were last used, and no more of them than this.
constexpr std::chrono::minutes kKeptFor{10};
constexpr std::size_t kMaxKept = 32;
constexpr std::chrono::milliseconds kLookWhetherMade{20};

}  // namespace

std::shared_ptr<const KeptAnswer> KeptAnswers::get(const std::string& key, const Call& call,
                                                   const std::function<Response()>& make,
                                                   std::optional<Response>& made) {
  std::shared_ptr<const KeptAnswer> found;
  while (!begin_making(key, found)) {
    if (found) return found;
    const Connection::Wake wake =
        call.connection.wait(nullptr, Clock::now() + kLookWhetherMade, half_closed(call.request));
    if (wake == Connection::Wake::kClientGone) throw ConnectionLost("the client has gone");
  }
  std::shared_ptr<const KeptAnswer> kept;
  try {
    Response answer = make();
    if (std::optional<Spool::File> body = answer.status == 200 ? spool_.keep(answer.body) : std::nullopt) {
      answer.body = std::string();
      kept = std::make_shared<const KeptAnswer>(KeptAnswer{std::move(answer), *std::move(body)});
    } else {
      made = std::move(answer);
    }
  } catch (...) {
    end_making(key, nullptr);
    throw;
  }
  end_making(key, kept);
  return kept;
}

std::shared_ptr<const KeptAnswer> KeptAnswers::find(const std::string& key) {
  const std::lock_guard lock(mutex_);
  const auto entry = entries_.find(key);
  if (entry == entries_.end()) return nullptr;
  entry->second.used = Clock::now();
  return entry->second.answer;
}

void KeptAnswers::forget(std::string_view begin) {
  const std::lock_guard lock(mutex_);
  std::erase_if(entries_, [&](const auto& entry) { return entry.second.answer && entry.first.starts_with(begin); });
}

/// Output: true if this caller has to make the answer. Otherwise `found` has it, or another caller is making it.
bool KeptAnswers::begin_making(const std::string& key, std::shared_ptr<const KeptAnswer>& found) {
  const std::lock_guard lock(mutex_);
  drop_old();
  const auto [entry, is_new] = entries_.try_emplace(key);
  entry->second.used = Clock::now();
  found = entry->second.answer;
  return is_new;
}

/// Input: `answer` is null if it could not be made or kept. Then the next caller makes it anew.
void KeptAnswers::end_making(const std::string& key, std::shared_ptr<const KeptAnswer> answer) {
  const std::lock_guard lock(mutex_);
  if (!answer) {
    entries_.erase(key);
    return;
  }
  entries_[key] = {std::move(answer), Clock::now()};
}

void KeptAnswers::drop_old() {
  const Clock::time_point oldest = Clock::now() - kKeptFor;
  std::erase_if(entries_, [&](const auto& entry) { return entry.second.answer && entry.second.used < oldest; });
  while (entries_.size() >= kMaxKept) {
    const auto least = std::min_element(entries_.begin(), entries_.end(), [](const auto& a, const auto& b) {
      return std::pair(a.second.answer == nullptr, a.second.used) <
             std::pair(b.second.answer == nullptr, b.second.used);
    });
    if (!least->second.answer) return;  // all of them are being made
    entries_.erase(least);
  }
}

}  // namespace remesh::server::jobs
