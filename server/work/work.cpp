#include "server/work/work.h"

#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "server/http/content_coding.h"
#include "server/http/digest.h"
#include "server/observe/log.h"
#include "server/work/memory_budget.h"

namespace remesh::server {
namespace {

/// How long cancelled work may take to stop. After this time the request is answered, and the result of the work is
/// dropped.
constexpr std::chrono::seconds kStopPatience{2};
/// The min time to wait for a worker, for a request that has waited long for memory.
constexpr std::chrono::seconds kMinQueueTime{1};
/// The bounds on the Retry-After that clients are told, in seconds.
constexpr std::int64_t kMinRetry = 1;
constexpr std::int64_t kMaxRetry = 300;

/// The state that the connection's thread and the pool's thread share. Either may be the last to own it.
class PoolTask {
 public:
  PoolTask(Request& request, const WorkLimits& limits, Operation operation, std::shared_ptr<RunningRequest> running)
      : running_(std::move(running)),
        limits_(limits.api),
        operation_(std::move(operation)),
        body_(std::move(request.body)),
        accept_encoding_(request.list("accept-encoding")) {
    input_.content_type = request.header("content-type");
    input_.content_encoding = request.list("content-encoding");
    input_.accept = request.list("accept");
    input_.query = std::move(request.query);
    input_.body = body_;
    input_.release_body = [this] { body_.rest(); };  // it may be needed for another attempt
  }

  void run() {
    {
      const std::lock_guard lock(mutex_);
      started_ = Clock::now();
    }
    running_->is_computing = true;  // no wake-up is needed, since this only moves deadlines back
    std::optional<api::Response> response;
    std::exception_ptr failure;
    try {
      running_->control.check();
      response = operation_(input_, with_trace(limits_, running_->id), running_->control);
      finish(*response);
    } catch (...) {
      failure = std::current_exception();
    }
    running_->is_computing = false;
    {
      const std::lock_guard lock(mutex_);
      ended_ = Clock::now();
      response_ = std::move(response);
      failure_ = std::move(failure);  // from here on only the waiting thread refers to it
      is_done_ = true;
    }
    running_->changed.set();
  }

  std::optional<Clock::time_point> started() const {
    const std::lock_guard lock(mutex_);
    return started_;
  }
  bool is_done() const {
    const std::lock_guard lock(mutex_);
    return is_done_;
  }
  /// Writes the times of a task that has ended.
  void report_times(Timing& timing) const {
    const std::lock_guard lock(mutex_);
    timing.queue = milliseconds_between(running_->start, *started_);
    timing.work = milliseconds_between(*started_, ended_);
  }
  /// Gives the request its parts back, so that it can be used again. If the operation released the body, the body
  /// rests.
  /// Output: false if the work has not ended and still uses these parts.
  bool give_back(Request& request) {
    const std::lock_guard lock(mutex_);
    if (!is_done_) return false;
    request.body = std::move(body_);
    request.query = std::move(input_.query);
    return true;
  }
  api::Response take_response() {
    const std::lock_guard lock(mutex_);
    if (failure_) std::rethrow_exception(std::exchange(failure_, nullptr));
    return std::move(*response_);
  }

 private:
  /// Applies the steps that every result gets: compression if the client accepts it, and a digest of the bytes that
  /// are sent.
  void finish(api::Response& response) const {
    if (response.status != 200) return;
    compress(response, accept_encoding_, running_->control);
    response.headers.emplace_back("Repr-Digest", repr_digest(response.body));
  }

  const std::shared_ptr<RunningRequest> running_;
  const api::Limits limits_;
  const Operation operation_;
  Body body_;
  std::string accept_encoding_;
  api::Request input_;

  mutable std::mutex mutex_;
  std::optional<Clock::time_point> started_;
  Clock::time_point ended_{};
  std::optional<api::Response> response_;
  std::exception_ptr failure_;
  bool is_done_ = false;
};

/// Waits for a task that was told to stop.
/// Errors: the remesh::Error of the stop, if the task does not end in time.
api::Response wait_for_stop(PoolTask& task, RunningRequest& running) {
  const Clock::time_point patience = Clock::now() + kStopPatience;
  while (!task.is_done() && Clock::now() < patience) {
    running.changed.wait(patience);
    running.changed.clear();
  }
  if (!task.is_done()) running.control.check();
  return task.take_response();
}

/// Waits until the task is done or must be stopped.
/// Input: `last_start` - the latest time for its start; `end` - the latest time for its end, if it is tried again.
api::Response wait_for(PoolTask& task, RunningRequest& running, const Workplace& place, WorkerPool::Ticket ticket,
                       const Call& call, Clock::time_point last_start, Clock::time_point end) {
  const std::chrono::milliseconds timeout = place.limits.api.request_timeout;
  const auto time_is_over = [&](Clock::time_point start) { return std::min(start + timeout, end); };
  for (;;) {
    const std::optional<Clock::time_point> begun = task.started();
    const Clock::time_point until = begun ? time_is_over(*begun) : last_start;
    const Connection::Wake wake = call.connection.wait(&running.changed, until, half_closed(call.request));
    running.changed.clear();
    if (task.is_done()) {
      task.report_times(call.request.timing);
      return task.take_response();
    }

    if (wake == Connection::Wake::kClientGone) running.control.cancel();
    if (!running.control.is_stopped() && Clock::now() < until) continue;
    if (place.pool.withdraw(ticket)) {
      running.control.check();
      throw overloaded(place.pool);
    }
    if (!running.control.is_stopped()) {
      // The task may have started just now, and then it gets its full time.
      const std::optional<Clock::time_point> started = task.started();
      if (!started || Clock::now() < time_is_over(*started)) continue;
      running.control.expire();
    }
    return wait_for_stop(task, running);
  }
}

/// The work was stopped because all requests together took too much memory. It may be tried again.
struct StoppedForMemory {
  std::uint64_t estimate;  ///< the bytes to reserve for the next attempt
};

/// Waits until this much memory is free, and reserves it. Meanwhile the request reserves nothing.
/// Errors: HttpError 503 - the time is over; remesh::Error - the client is gone or has cancelled the request.
void reserve_again(std::uint64_t bytes, RunningRequest& running, const Call& call, Clock::time_point end) {
  MemoryShare& memory = *call.request.memory;
  memory.hold_answer(0);
  wait_for_memory(
      memory, [&] { return memory.try_hold(bytes); }, call.request, call.connection, end, &running.changed,
      [&](Connection::Wake wake) {
        if (wake == Connection::Wake::kClientGone) running.control.cancel();
        running.changed.clear();
        running.control.check();
      });
}

/// Does the work once.
/// Input:  as `wait_for`; `effort` - the size of a body by which the effort is judged.
/// Errors: those of the work; StoppedForMemory.
api::Response run_once(const Workplace& place, const std::shared_ptr<RunningRequest>& running,
                       const Operation& operation, const Call& call, std::uint64_t effort, Clock::time_point last_start,
                       Clock::time_point end) {
  Request& request = call.request;
  const auto task = std::make_shared<PoolTask>(request, place.limits, operation, running);
  const std::optional<WorkerPool::Ticket> ticket = place.pool.try_submit([task] { task->run(); }, effort);
  if (!ticket) throw overloaded(place.pool);
  try {
    api::Response response = wait_for(*task, *running, place, *ticket, call, last_start, end);
    task->give_back(request);
    return response;
  } catch (const Error& error) {
    if (error.code != Code::kCancelled || running->was_cancelled) throw;
    switch (running->eviction.load()) {
      case RunningRequest::Eviction::kNone: throw;
      case RunningRequest::Eviction::kAlone: throw never_fits(place.limits.memory_budget);
      case RunningRequest::Eviction::kAmongOthers: break;
    }
    if (!task->give_back(request)) throw out_of_memory();
    request.body.seal();
    throw StoppedForMemory{request.memory->next_reservation(running->next_estimate(request.memory->bytes()))};
  }
}

/// Does the work, and repeats it if it is stopped because of its memory.
/// Input:  as `run_once`.
api::Response run_until_done(const Workplace& place, const Operation& operation, const Call& call,
                             std::uint64_t effort) {
  Request& request = call.request;
  const std::chrono::milliseconds timeout = place.limits.api.request_timeout;
  if (request.memory->budget().is_closed()) throw draining();  // its upload ended after the others were cancelled
  const Clock::time_point start = Clock::now();
  const Clock::time_point end_of_retries = start + timeout;
  // The time to wait for a worker is the rest of the time to wait for memory, or enough to find a free worker.
  Clock::time_point last_start =
      start + std::max<Clock::duration>(timeout - request.waited, std::min<Clock::duration>(kMinQueueTime, timeout));
  Clock::time_point end = Clock::time_point::max();
  for (std::optional<std::uint64_t> estimate;; end = last_start = end_of_retries) {
    const RequestRegistry::Entry running = place.registry.add(request.id, request.owner);
    request.id = running->id;
    try {
      if (estimate) reserve_again(*estimate, *running.get(), call, end);
      return run_once(place, running.get(), operation, call, effort, last_start, end);
    } catch (const StoppedForMemory& stopped) {
      estimate = stopped.estimate;
    } catch (const Error& error) {
      if (error.code == Code::kCancelled && request.memory->budget().is_closed()) throw draining();
      throw;
    }
  }
}

}  // namespace

api::Limits with_trace(const api::Limits& limits, const std::string& id) {
  api::Limits traced = limits;
  if (log::is_written(log::Level::kDebug))
    traced.trace = [id](const std::string& line) {
      log::write(log::Level::kDebug, "attempt", {{"id", id}, {"decided", line}});
    };
  return traced;
}

HttpError overloaded(const WorkerPool& pool) {
  const auto wait = std::chrono::ceil<std::chrono::seconds>(pool.expected_wait()).count();
  return HttpError(503, "overloaded", "all workers are busy and the queue is full: try again shortly")
      .with_header("Retry-After", std::to_string(std::clamp<std::int64_t>(wait, kMinRetry, kMaxRetry)));
}

Response run_in_pool(const Workplace& place, const Operation& operation, const Call& call) {
  Response response;
  static_cast<api::Response&>(response) = run_until_done(place, operation, call, call.request.body.size());
  call.request.body = {};
  call.request.memory->hold_answer(response.body.size());
  return response;
}

void check_in_pool(const Workplace& place, Check check, const Call& call) {
  const Operation operation = [check = std::move(check)](const auto& request, const auto& limits, auto& control) {
    check(request, limits, control);
    return api::Response{204, "", "", {}};
  };
  const std::uint64_t held = call.request.memory->bytes();
  run_until_done(place, operation, call, std::min<std::uint64_t>(call.request.body.size(), WorkerPool::kSmallBytes));
  call.request.memory->hold_answer(held);  // another attempt may have reserved more
}

}  // namespace remesh::server
