#include "server/http/exchange.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "server/observe/trace_context.h"

namespace remesh::server {
namespace {

/// The status that is counted for a request whose client left before its answer.
constexpr int kClientClosedRequest = 499;
constexpr std::array<int, 8> kRejections{401, 408, 411, 413, 414, 429, 431, 503};

void add_times(const Exchange& exchange, std::vector<log::Field>& fields) {
  const Timing& timing = exchange.request.timing;
  fields.push_back({"ms", milliseconds_between(exchange.start, Clock::now())});
  if (timing.body) fields.push_back({"body_ms", *timing.body});
  if (timing.queue) fields.push_back({"queue_ms", *timing.queue});
  if (timing.work) fields.push_back({"work_ms", *timing.work});
}

void log_access(const Exchange& exchange, Outcome outcome) {
  const Request& request = exchange.request;
  const bool is_probe = request.path == "/livez" || request.path == "/readyz" || request.path == "/metrics";
  const log::Level level = is_probe ? log::Level::kDebug : log::Level::kInfo;
  if (!log::is_written(level)) return;
  std::vector<log::Field> fields{{"id", request.id},
                                 {"method", request.method},
                                 {"path", request.path},
                                 {"status", std::int64_t{exchange.status}},
                                 {"bytes_in", static_cast<std::int64_t>(exchange.connection.bytes_read())},
                                 {"bytes_out", static_cast<std::int64_t>(exchange.connection.bytes_written())},
                                 {"peer", exchange.connection.peer_address()},
                                 {"outcome", std::string(outcome == Outcome::kAnswered ? "answered" : "client_gone")}};
  if (exchange.client != exchange.connection.peer_address()) fields.push_back({"client", exchange.client});
  if (!request.key.empty()) fields.push_back({"key", request.key});
  if (!exchange.job.empty()) fields.push_back({"job", exchange.job});
  if (!exchange.problem_code.empty()) fields.push_back({"code", exchange.problem_code});
  if (const auto trace = parse_traceparent(request.header("traceparent"))) {
    fields.push_back({"trace_id", trace->trace_id});
    fields.push_back({"parent_id", trace->parent_id});
  }
  add_times(exchange, fields);
  if (exchange.done) add_work(*exchange.done, fields);
  log::write(level, "request", fields);
}

void count(const Exchange& exchange, Outcome outcome, Metrics& metrics) {
  const int status = outcome == Outcome::kAnswered ? exchange.status : kClientClosedRequest;
  const std::string_view method = exchange.request.method.empty() ? "none" : std::string_view(exchange.request.method);
  metrics.count_request(exchange.route, method, status,
                        std::chrono::duration<double>(Clock::now() - exchange.start).count());
  const bool is_refusal = std::find(kRejections.begin(), kRejections.end(), exchange.status) != kRejections.end();
  if (is_refusal && !exchange.is_told) metrics.count_rejection(exchange.problem_code);
  if (exchange.done) metrics.count_work(*exchange.done);
  const Request& request = exchange.request;
  if (!request.key.empty()) metrics.count_key(request.key, status, request.timing.work.value_or(0) / 1000);
}

}  // namespace

void add_work(const api::WorkDone& done, std::vector<log::Field>& fields) {
  fields.push_back({"input_faces", static_cast<std::int64_t>(done.input_faces)});
  fields.push_back({"output_faces", static_cast<std::int64_t>(done.output_faces)});
  for (const auto& [stage, ms] : done.stages_ms) fields.push_back({stage, ms});
}

void account_for(const Exchange& exchange, Outcome outcome, Metrics* metrics) {
  if (metrics != nullptr) count(exchange, outcome, *metrics);
  log_access(exchange, outcome);
}

}  // namespace remesh::server
