#include "server/jobs/job_routes.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "api/quoting.h"
#include "server/http/content_coding.h"
#include "server/http/header_lists.h"
#include "server/http/partial_content.h"
#include "server/jobs/job_request.h"
#include "server/jobs/store_deadline.h"
#include "server/observe/log.h"
#include "server/work/memory_wait.h"

namespace remesh::server::jobs {
namespace {

constexpr const char* kPollSeconds = "1";
constexpr const char* kFullSeconds = "10";
constexpr int kMaxListed = 100;
/// Memory that an answer takes, as a multiple of the stored bytes. For a mesh, the unpacked mesh and its text count;
/// for a report, the stored bytes and the text made from them. On half a million faces, 4 to 7 times was measured,
/// depending on the format, and 9 times for VTU.
constexpr std::uint64_t kPerMeshByte = 7;
constexpr std::uint64_t kPerMeshByteOfVtu = 9;
constexpr std::uint64_t kPerReportByte = 2;
constexpr std::chrono::milliseconds kLookForEvents{300};
/// The interval of messages in a silent stream. Some proxies cut silent streams, and without sending the daemon would
/// not notice that the client is gone.
constexpr std::chrono::seconds kSilence{15};

HttpError not_found() { return HttpError(404, "not_found", "there is no job with this id"); }

HttpError expired() { return HttpError(410, "result_expired", "the result has expired or was deleted"); }

/// Calls a function that asks the store.
/// Errors: HttpError 503 or 507 instead of StoreError and NoFolder.
template <typename Question>
auto ask(Question question) {
  try {
    return question();
  } catch (const StoreFull& error) {
    throw HttpError(507, "storage_full", "the store of jobs has no room: " + std::string(error.what()))
        .with_header("Retry-After", kFullSeconds);
  } catch (const StoreError&) {
    throw store_unavailable();  // the store's observer has logged the reason
  } catch (const NoFolder& error) {
    log::write(log::Level::kError, "a stored blob cannot be read", {{"error", std::string(error.what())}});
    throw store_unavailable();  // another daemon may have the blob folder
  }
}

bool is_job_id(std::string_view text) {
  return text.size() == 32 &&
         std::all_of(text.begin(), text.end(), [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); });
}

api::Request kept_part(const Request& request) {
  api::Request kept;
  kept.content_type = request.header("content-type");
  kept.content_encoding = request.list("content-encoding");
  kept.accept = request.list("accept");
  kept.query = request.query;
  return kept;
}

std::optional<Idempotency> idempotency(const Request& request, const api::Request& kept) {
  const std::string_view key = request.header("idempotency-key");
  const bool is_sent = std::any_of(request.headers.begin(), request.headers.end(),
                                   [](const auto& header) { return header.first == "idempotency-key"; });
  if (!is_sent) return std::nullopt;
  const bool is_plain = std::all_of(key.begin(), key.end(), [](char c) { return c >= ' ' && c < 0x7f; });
  if (key.empty() || key.size() > 255 || !is_plain) {
    throw HttpError(400, "malformed_request", "an Idempotency-Key must have 1 to 255 visible ASCII characters");
  }
  return Idempotency{std::string(key), request_digest(kept)};
}

/// Gives the answer to a request for the result of a job that has none. A failed job is answered as its request would
/// have been.
/// Output: nothing if the job has a result.
/// Errors: HttpError - the job is not finished or has expired.
std::optional<Response> answer_without_result(const JobRecord& job) {
  switch (job.state) {
    case JobState::kSucceeded: return std::nullopt;
    case JobState::kQueued:
    case JobState::kRunning:
      throw HttpError(409, "job_not_finished", "the job is " + std::string(state_name(job.state)))
          .with_header("Retry-After", kPollSeconds);
    case JobState::kExpired: throw expired();
    case JobState::kFailed:
    case JobState::kCancelled: break;
  }
  Response response;
  response.status = job.problem_status;
  response.content_type = "application/problem+json";
  response.body = job.problem;
  response.problem_code = problem_code(job.problem);
  response.is_told = true;
  return response;
}

/// True if the answer may have the format with the largest texts. A request that names no format gets the format that
/// was chosen when the job was submitted.
bool may_get_vtu(const Request& request) {
  const auto named = std::find_if(request.query.begin(), request.query.end(),
                                  [](const auto& option) { return option.first == "format"; });
  return named == request.query.end() || named->second == "vtu";
}

/// True if a request asks for less than a whole body, so that others like it will follow.
bool asks_for_parts(const Request& request) {
  return request.method == "HEAD" || request.has("range") || request.has("if-none-match") || request.has("if-match");
}

/// Names the bytes of a result.
std::string key_of_result(const std::string& id, const Request& request) {
  std::string key = id;
  for (const std::string& part : {request.list("accept"), request.list("accept-encoding")}) key += '\n' + part;
  for (const auto& [name, value] : request.query) key += '\n' + name + '=' + value;
  return key;
}

/// The record of a job that has just been stored.
std::optional<JobRecord> new_record(const NewJob& job, const Submission& submission) {
  JobRecord record;
  record.id = submission.id;
  record.owner = job.owner;
  record.stage = state_name(JobState::kQueued);
  record.version = 1;
  record.created_ms = submission.created_ms;
  return record;
}

std::string event_of(const JobRecord& job, const JobLinks& links) {
  return "id: " + std::to_string(job.version) + "\nevent: " + (is_final(job.state) ? "end" : "progress") +
         "\ndata: " + job_json(job, links) + "\n\n";
}

/// The stream of events of one job. Each new version of the job's record is sent as a whole, so a client that
/// reconnects with the last version it saw misses nothing important. The stream ends when the daemon is about to stop,
/// and the client continues it with another daemon. It also ends when the key of the job's owner is no longer valid.
class EventStream {
 public:
  EventStream(JobStore& store, const ApiKeys& keys, JobRecord first, std::int64_t seen, const Call& call,
              const std::atomic<bool>& draining)
      : store_(store),
        keys_(keys),
        job_(std::move(first)),
        seen_(seen),
        connection_(call.connection),
        links_{call.request.prefix},
        draining_(draining) {}

  /// Output: empty at the end of the stream.
  std::string next() {
    if (is_over_) return {};
    for (;;) {
      if (job_.version != seen_) {
        seen_ = job_.version;
        is_over_ = is_final(job_.state);
        silent_until_ = Clock::now() + kSilence;
        return event_of(job_, links_);
      }
      if (draining_ || !keys_.has_owner(job_.owner)) return {};
      if (Clock::now() >= silent_until_) {
        silent_until_ = Clock::now() + kSilence;
        return ": still here\n\n";
      }
      if (connection_.wait(nullptr, Clock::now() + kLookForEvents) == Connection::Wake::kClientGone) return {};
      try {
        std::optional<JobRecord> now = store_.find(job_.id);
        if (!now) return {};
        job_ = std::move(*now);
      } catch (const StoreError&) {
        // The store may come back; otherwise the client will leave at some time.
      }
    }
  }

 private:
  JobStore& store_;
  const ApiKeys& keys_;
  JobRecord job_;
  std::int64_t seen_;
  Connection& connection_;
  const JobLinks links_;  ///< without tokens, since the stream may live longer than they do
  const std::atomic<bool>& draining_;
  bool is_over_ = false;
  Clock::time_point silent_until_ = Clock::now() + kSilence;
};

}  // namespace

HttpError store_unavailable() {
  return HttpError(503, "store_unavailable", "the store of jobs cannot be reached or written now: try again shortly");
}

std::vector<Route> JobRoutes::routes() {
  const auto admission = [this](const RequestHead& head) { return admit(head); };
  const auto handler = [this](Response (JobRoutes::*answer)(const Call&) const) {
    return [this, answer](const Call& call) {
      const SharedStoreDeadline deadline(jobs().deadline());
      return (this->*answer)(call);
    };
  };
  const std::string path = "/v1/jobs/{id}";
  return {{"POST", "/v1/jobs", [this](const Call& call) { return submit(call); }, admission},
          {"GET", "/v1/jobs", handler(&JobRoutes::list)},
          {"GET", path, handler(&JobRoutes::show)},
          {"DELETE", path, handler(&JobRoutes::remove)},
          {"GET", path + "/result", handler(&JobRoutes::result)},
          {"GET", path + "/report", handler(&JobRoutes::report)},
          {"GET", path + "/events", handler(&JobRoutes::follow), nullptr, Access::kGuarded,
           /*takes_token=*/true}};
}

bool JobRoutes::wants_job(const RequestHead& head) {
  const std::string preferences = head.list("prefer");
  for (const std::string_view preference : list_elements(preferences)) {
    if (api::ascii_lower(trimmed(api::cut(preference, ';').first)) == "respond-async") return true;
  }
  return false;
}

JobService& JobRoutes::jobs() const {
  if (context_.jobs == nullptr) {
    throw HttpError(501, "not_implemented",
                    "this server has no store for jobs; its operator can set --state-dir or --store");
  }
  return *context_.jobs;
}

JobLinks JobRoutes::links_for(const Request& request) const {
  return {request.prefix, [this, &request](const std::string& path) {
            return context_.keys.token(request, path, std::chrono::system_clock::now());
          }};
}

Admission JobRoutes::admit(const RequestHead& head) const {
  check_content_coding(head);
  if (context_.draining) throw draining();
  if (!jobs().is_well()) throw store_unavailable();
  // If the folder of jobs is in memory, stored data reduces the memory for all work.
  if (context_.memory.stored() > context_.memory.limit() / 2) {
    throw HttpError(507, "storage_full",
                    "the store of jobs is in memory, and its data takes half of the memory "
                    "budget")
        .with_header("Retry-After", kFullSeconds);
  }
  if (jobs().is_full()) throw HttpError(503, "overloaded", "the queue of jobs is full: try again later");
  // The request only passes the body on to the store, which copies it, so each byte counts twice. The worker that
  // claims the job reserves the memory for the work.
  return {context_.work.limits.api.max_body, context_.memory.open_share(/*per_byte=*/2)};
}

Response JobRoutes::submit(const Call& call) const {
  const Request& request = call.request;
  api::Request kept = kept_part(request);
  NewJob job;
  job.request = pack_request(kept);
  kept.body = request.body;
  job.idempotency = idempotency(request, kept);
  if (api::check_remesh(kept, context_.work.limits.api)) check_in_pool(context_.work, api::check_json, call);

  if (request.body.size() > context_.memory.limit()) throw never_fits(context_.memory.limit());
  job.memory = std::max<std::uint64_t>(
      request.body.size(),
      std::min(request.body.size() * MemoryBudget::kWorkPerBodyByte, context_.memory.usual_limit()));
  job.id = new_request_id();
  job.owner = request.owner;
  job.body = request.body;
  const SharedStoreDeadline deadline(jobs().deadline());  // the deadline begins after the body has been checked
  const Submission submission = ask([&] { return jobs().store().submit(job); });
  if (submission.kind == Submission::Kind::kKeyReused)
    throw HttpError(422, "idempotency_key_reused", "this Idempotency-Key was sent with another request");
  jobs().wake();

  // A new job is shown as it was stored, so that no failure from here on can hide it from its client.
  const auto record = submission.kind == Submission::Kind::kNew
                          ? new_record(job, submission)
                          : ask([&] { return jobs().store().find(submission.id); });
  if (!record) throw HttpError(410, "result_expired", "the job of this Idempotency-Key no longer exists");
  Response response = json_response(job_json(*record, links_for(request)));
  response.status = 202;
  response.job = submission.id;
  response.headers.emplace_back("Location", request.prefix + job_path(submission.id));
  response.headers.emplace_back("Retry-After", kPollSeconds);
  if (wants_job(request)) response.headers.emplace_back("Preference-Applied", "respond-async");
  return response;
}

/// Errors: HttpError 404 - also if the job belongs to another owner, so that ids cannot be probed.
JobRecord JobRoutes::find_own(const Call& call) const {
  JobStore& store = jobs().store();
  if (!is_job_id(call.parameter)) throw not_found();
  std::optional<JobRecord> job = ask([&] { return store.find(call.parameter); });
  if (!job || job->owner != call.request.owner) throw not_found();
  return std::move(*job);
}

Response JobRoutes::list(const Call& call) const {
  JobStore& store = jobs().store();
  const std::string& owner = call.request.owner;
  if (owner.empty()) {
    throw HttpError(
        403, "forbidden",
        "jobs are listed only for the owner of an API key, and this server uses no API keys: here the id of a "
        "job is the only secret that protects it");
  }
  return compressed(
      json_response(jobs_json(ask([&] { return store.list(owner, kMaxListed); }), links_for(call.request))),
      call.request);
}

Response JobRoutes::show(const Call& call) const {
  const JobRecord job = find_own(call);
  Response response = json_response(job_json(job, links_for(call.request)));
  if (!is_final(job.state)) response.headers.emplace_back("Retry-After", kPollSeconds);
  return response;
}

Response JobRoutes::remove(const Call& call) const {
  const JobRecord job = find_own(call);
  ask([&] { jobs().remove(job.id); });
  context_.kept.forget(job.id);
  Response response;
  response.status = 204;
  return response;
}

std::string JobRoutes::read(const std::string& id, BlobKind kind) const {
  std::optional<std::string> bytes = ask([&] { return jobs().store().read_blob(id, kind); });
  if (!bytes) throw expired();
  return std::move(*bytes);
}

std::uint64_t JobRoutes::size_of(const std::string& id, BlobKind kind) const {
  const std::optional<std::uint64_t> size = ask([&] { return jobs().store().blob_size(id, kind); });
  if (!size) throw expired();
  return *size;
}

Response JobRoutes::answer_from(const Operation& write, std::uint64_t memory, const Call& call) const {
  call.request.memory = context_.memory.open_share(/*per_byte=*/1);
  // The reservation is limited to the whole budget: a result that a worker could make can always be sent, if necessary
  // with no other work beside it.
  memory = std::min(memory, context_.memory.limit());
  wait_for_memory(
      *call.request.memory, [&] { return call.request.memory->try_hold(memory); }, call.request, call.connection,
      end_of_waiting(call.request, context_.work.limits.api.request_timeout));
  return run_in_pool(context_.work, write, call);
}

Response JobRoutes::answer_from(const KeptAnswer& kept, const Call& call) const {
  const auto read = [&](std::uint64_t begin, std::uint64_t end) {
    call.request.memory = context_.memory.open_share(/*per_byte=*/1);
    const std::uint64_t bytes = std::min(end - begin, context_.memory.limit());
    wait_for_memory(
        *call.request.memory, [&] { return call.request.memory->try_hold(bytes); }, call.request, call.connection,
        end_of_waiting(call.request, context_.work.limits.api.request_timeout));
    return kept.body.read(begin, end);
  };
  return with_ranges(kept.head, call.request, kept.body.size(), read);
}

Response JobRoutes::result(const Call& call) const {
  const JobRecord job = find_own(call);
  if (std::optional<Response> problem = answer_without_result(job)) return std::move(*problem);
  const std::uint64_t per_byte = may_get_vtu(call.request) ? kPerMeshByteOfVtu : kPerMeshByte;
  const std::uint64_t memory =
      per_byte * size_of(job.id, BlobKind::kMesh) + kPerReportByte * size_of(job.id, BlobKind::kReport);
  const Operation write = [this, id = job.id](const api::Request& wanted, const api::Limits&, RunControl& control) {
    return api::write_kept(
        read(id, BlobKind::kMesh), [&] { return read(id, BlobKind::kReport); }, wanted, control);
  };
  // To write a result takes as long for one of its bytes as for all.
  const std::string key = key_of_result(job.id, call.request);
  std::optional<Response> made;
  const auto make = [&] { return answer_from(write, memory, call); };
  if (const auto kept =
          asks_for_parts(call.request) ? context_.kept.get(key, call, make, made) : context_.kept.find(key))
    return answer_from(*kept, call);
  return with_ranges(made ? *std::move(made) : make(), call.request);
}

Response JobRoutes::report(const Call& call) const {
  const JobRecord job = find_own(call);
  if (std::optional<Response> problem = answer_without_result(job)) return std::move(*problem);
  const std::uint64_t memory = kPerReportByte * size_of(job.id, BlobKind::kReport);
  const Operation write = [this, id = job.id](const api::Request&, const api::Limits&, RunControl&) {
    return api::Response{200, "application/json", read(id, BlobKind::kReport), {{"Cache-Control", "no-store"}}};
  };
  return with_ranges(answer_from(write, memory, call), call.request);
}

Response JobRoutes::follow(const Call& call) const {
  JobRecord job = find_own(call);
  const std::string_view last = call.request.header("last-event-id");
  std::int64_t seen = 0;
  std::from_chars(last.data(), last.data() + last.size(), seen);
  Response response;
  if (is_final(job.state) && job.version == seen) {
    response.status = 204;  // there will be no more events, and browsers stop asking after a 204
    return response;
  }
  response.content_type = "text/event-stream";
  response.headers = event_stream_headers();
  response.next_piece = [stream = std::make_shared<EventStream>(jobs().store(), context_.keys, std::move(job), seen,
                                                                call, context_.draining)] { return stream->next(); };
  return response;
}

}  // namespace remesh::server::jobs
