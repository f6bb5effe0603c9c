#include "server/work/request_registry.h"

#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <system_error>

namespace remesh::server {

std::string progress_json(RunningRequest& request) {
  // Ids and stage names need no escaping, because is_request_id permits no such characters.
  const double fraction = request.overall.look(request.control), elapsed = request.elapsed_s();
  std::array<char, 96> numbers;
  std::snprintf(numbers.data(), numbers.size(), "\"fraction\":%.4f,\"elapsed_s\":%.3f", fraction, elapsed);
  std::string text = "{\"id\":\"" + request.id + "\",\"stage\":\"" + std::string(stage_name(request.control.stage())) +
                     "\"," + numbers.data();
  const std::optional<double> left = api::seconds_left(fraction, elapsed);
  std::snprintf(numbers.data(), numbers.size(), "%.1f", left.value_or(0));
  return text + ",\"left_s\":" + (left ? numbers.data() : "null") + "}";
}

RequestRegistry::Entry RequestRegistry::add(const std::string& id, const std::string& owner) {
  // The request is made outside the lock, because its event needs a system call.
  for (auto request = std::make_shared<RunningRequest>(id, owner);;
       request = std::make_shared<RunningRequest>(new_request_id(), owner)) {
    const std::lock_guard lock(mutex_);
    if (running_.emplace(Key(request->owner, request->id), request).second) return Entry(*this, std::move(request));
  }
}

std::shared_ptr<RunningRequest> RequestRegistry::find(const std::string& id, const std::string& owner) const {
  const std::lock_guard lock(mutex_);
  const auto found = running_.find(Key(owner, id));
  return found == running_.end() ? nullptr : found->second;
}

std::vector<std::shared_ptr<RunningRequest>> RequestRegistry::computing() const {
  const std::lock_guard lock(mutex_);
  std::vector<std::shared_ptr<RunningRequest>> found;
  for (const auto& [key, request] : running_) {
    if (request->is_computing) found.push_back(request);
  }
  return found;
}

void RequestRegistry::cancel_all() {
  const std::lock_guard lock(mutex_);
  for (const auto& [key, request] : running_) request->cancel();
}

void RequestRegistry::remove(RunningRequest& request) {
  request.has_ended = true;
  const std::lock_guard lock(mutex_);
  running_.erase(Key(request.owner, request.id));
}

bool is_request_id(std::string_view text) {
  return text.size() >= 16 && text.size() <= 64 && std::all_of(text.begin(), text.end(), [](char c) {
           return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' || c == '_' ||
                  c == '.' || c == '~';
         });
}

std::string new_request_id() {
  // The id comes from the system's random source. Anyone who knows an id can cancel the request, so the id must not be
  // guessable.
  std::array<std::uint32_t, 4> words{};
  if (::getentropy(words.data(), sizeof words) != 0)
    throw std::system_error(errno, std::generic_category(), "no random numbers");
  std::string id;
  for (const std::uint32_t word : words) {
    std::array<char, 9> digits;
    std::snprintf(digits.data(), digits.size(), "%08x", word);
    id += digits.data();
  }
  return id;
}

}  // namespace remesh::server
