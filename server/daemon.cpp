#include "server/daemon.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <system_error>
#include <thread>
#include <utility>

#include "server/http/content_coding.h"
#include "server/web_page.h"

namespace remesh::server {
namespace {

constexpr std::size_t kOpsConnections = 32;
constexpr std::chrono::milliseconds kProgressPeriod{250};
/// How long `stop` waits for the answers of cancelled requests.
constexpr std::chrono::milliseconds kLastAnswers{1000};

Response plain(int status, std::string text) {
  Response response;
  response.status = status;
  response.content_type = "text/plain; charset=utf-8";
  response.body = std::move(text);
  return response;
}

Response wrap(api::Response answer) {
  Response response;
  static_cast<api::Response&>(response) = std::move(answer);
  return response;
}

std::string sse(std::string_view event, const std::string& data) {
  return "event: " + std::string(event) + "\ndata: " + data + "\n\n";
}

std::shared_ptr<RunningRequest> find_own(const RequestRegistry& registry, const Call& call) {
  if (auto found = registry.find(call.parameter, call.request.owner)) return found;
  throw HttpError(404, "not_found", "no running request has this id");
}

}  // namespace

// This is the complete list of routes.
std::vector<Route> Daemon::routes() {
  const auto work_body = [this](const RequestHead& head) { return admit_work(head); };
  std::vector<Route> list = ops_routes();
  if (config_.jobs.role == jobs::Role::kWork) return list;
  for (Route& route : web_routes(web_files())) list.push_back(std::move(route));
  for (Route& route : job_routes_.routes()) list.push_back(std::move(route));
  list.push_back(
      {"GET", "/openapi.json", [this](const Call& call) { return compressed(show_contract(call), call.request); }});
  list.push_back({"GET", "/v1/capabilities", [this](const Call& call) {
                    return compressed(wrap(operations_.capabilities(work_limits_.api)), call.request);
                  }});
  list.push_back(
      {"POST", "/v1/remesh",
       [this](const Call& call) {
         return makes_job(call.request) ? job_routes_.submit(call) : run_in_pool(work_, operations_.remesh, call);
       },
       [this](const RequestHead& head) { return makes_job(head) ? job_routes_.admit(head) : admit_work(head); }});
  list.push_back({"POST", "/v1/analyze",
                  [this](const Call& call) { return run_in_pool(work_, operations_.analyze, call); }, work_body});
  list.push_back({"POST", "/v1/compare",
                  [this](const Call& call) { return run_in_pool(work_, operations_.compare, call); }, work_body});
  list.push_back({"GET", "/v1/requests/{id}", [this](const Call& call) { return show_request(call); }});
  list.push_back({"DELETE", "/v1/requests/{id}", [this](const Call& call) { return cancel_request(call); }});
  list.push_back({"GET", "/v1/requests/{id}/events", [this](const Call& call) { return follow_request(call); }});
  return list;
}

std::vector<Route> Daemon::ops_routes() {
  return {{"GET", "/livez", [](const Call&) { return plain(200, "alive\n"); }, nullptr, Access::kProbe},
          {"GET", "/readyz", [this](const Call&) { return readiness(); }, nullptr, Access::kProbe},
          {"GET", "/metrics", [this](const Call& call) { return compressed(show_metrics(), call.request); }}};
}

Daemon::Daemon(const Config& config, Operations operations)
    : config_(config),
      operations_(std::move(operations)),
      work_limits_{config.limits, config.memory_budget},
      work_{pool_, registry_, work_limits_},
      keys_(config.api_key_file, config.api_key),
      // Each request that waits for memory takes a connection, and some connections must stay free for requests that
      // watch or cancel.
      memory_(config.memory_budget, MemoryBudget::kPatience,
              std::max<std::size_t>(1, config.connections.max_connections / 4)),
      memory_watch_(memory_, registry_),
      spool_(spool_folder(), config.max_spooled, config.memory_budget / 4),
      kept_(spool_),
      jobs_(make_jobs()),
      job_routes_({jobs_.get(), keys_, work_, memory_, draining_, kept_}),
      pool_(config.max_running, config.limits.queue, config.limits.workers),
      http_(routes(), http_settings()) {
  if (!config.ops_bind) return;
  // This port has neither keys nor metrics of requests. Every client that can reach the port may read, and reading is
  // no work that counts.
  HttpSettings settings;
  settings.connections = config.connections;
  settings.connections.max_connections = settings.connections.max_connections_per_address = kOpsConnections;
  settings.sites = site_rules(*config.ops_bind);
  ops_ = std::make_unique<HttpServer>(ops_routes(), settings);
}

std::unique_ptr<jobs::JobService> Daemon::make_jobs() {
  std::unique_ptr<jobs::JobStore> store = jobs::open_store(config_.jobs, metrics_);
  if (!store) return nullptr;
  jobs::RunnerSettings settings;
  settings.worker = new_request_id().substr(0, 12);
  settings.limits = work_limits_.api;
  settings.max_held = static_cast<std::size_t>(config_.max_running);
  settings.rules = config_.jobs.rules;
  settings.job_timeout = config_.jobs.job_timeout;
  return std::make_unique<jobs::JobService>(std::move(store), config_.jobs, std::move(settings), pool_, registry_,
                                            memory_, metrics_, operations_.remesh_to_keep);
}

std::string Daemon::spool_folder() const {
  if (config_.spool_dir != "auto") return config_.spool_dir;
  const bool has_folder = config_.jobs.store == "sqlite";
  const std::string folder = has_folder ? jobs::find_state_dir(config_.jobs.state_dir) : "";
  std::error_code none;
  return folder.empty() ? std::filesystem::temp_directory_path(none).string() : folder;
}

std::optional<SiteRules> Daemon::site_rules(const Address& address) const {
  if (!keys_.is_open()) return std::nullopt;
  return SiteRules(config_.allowed_hosts, config_.public_url, config_.cors, address.is_loopback());
}

HttpSettings Daemon::http_settings() {
  HttpSettings settings;
  settings.connections = config_.connections;
  settings.keys = &keys_;
  settings.key_rules = config_.key_rules;
  settings.cors = config_.cors;
  settings.proxies = config_.trusted_proxies;
  settings.public_url = config_.public_url;
  settings.sites = site_rules(config_.bind);
  settings.metrics = &metrics_;
  settings.spool = &spool_;
  settings.memory_patience = work_limits_.memory_patience();
  return settings;
}

Daemon::~Daemon() { stop(); }

void Daemon::start() {
  http_.bind(config_.bind);
  if (ops_) ops_->bind(*config_.ops_bind);
  if (jobs_) jobs_->start();  // before listening, so that "ready" is said only after the store was asked
  http_.start();
  if (ops_) ops_->start();
}

void Daemon::begin_drain() {
  draining_ = true;
  http_.begin_drain();
  if (ops_) ops_->begin_drain();
  if (jobs_) jobs_->begin_drain();
}

void Daemon::stop() {
  begin_drain();
  memory_.close();  // requests that wait for memory are answered while jobs are given back
  if (jobs_) jobs_->stop();
  registry_.cancel_all();
  const Clock::time_point deadline = Clock::now() + kLastAnswers;
  while (!is_idle() && Clock::now() < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  http_.stop();
  if (ops_) ops_->stop();
}

bool Daemon::makes_job(const RequestHead& head) const { return jobs_ && jobs::JobRoutes::wants_job(head); }

Admission Daemon::admit_work(const RequestHead& head) {
  if (draining_) throw draining();
  check_content_coding(head);
  const Framing body = framing(head);
  // The length of a chunked body is unknown here. The queue checks its room again once the body has arrived.
  if (pool_.is_full(body.length)) throw overloaded(pool_);
  return {config_.limits.max_body, memory_.open_share()};
}

Response Daemon::show_contract(const Call& call) const {
  constexpr std::string_view kServer = "\"url\": \"/\"";  // the first of all URLs, and the only one of this kind
  Response response = wrap(operations_.openapi());
  const bool is_public = call.request.prefix == config_.public_url.prefix() && config_.public_url.origin();
  const std::string url = is_public ? config_.public_url.text() : call.request.prefix;
  const std::size_t at = response.body.find(kServer);
  if (url.empty() || at == std::string::npos) return response;
  // The URL and the prefix are validated when they are configured, so that they need no escapes here.
  response.body.replace(at, kServer.size(), "\"url\": \"" + url + "\"");
  return response;
}

Response Daemon::show_metrics() const {
  Gauges gauges;
  gauges.connections = http_.open_connections();
  gauges.running = pool_.running();
  gauges.queued = pool_.queued();
  gauges.workers = config_.limits.workers;
  gauges.busy = pool_.busy_threads();
  gauges.memory_reserved = memory_.reserved();
  gauges.memory_waiting = memory_.waiting();
  gauges.log_lines_dropped = log::dropped_lines();
  gauges.is_ready = !draining_ && (!jobs_ || jobs_->is_well());
  if (jobs_) {
    const jobs::QueueStatistics statistics = jobs_->statistics();
    gauges.has_jobs = true;
    gauges.jobs_queued = statistics.queued;
    gauges.jobs_running = statistics.running;
    gauges.job_oldest_queued_s = statistics.oldest_queued_s;
    gauges.jobs_stored_bytes = jobs_->stored_bytes();
  }
  Response response;
  response.content_type = "text/plain; version=0.0.4; charset=utf-8";
  response.body = metrics_.text(gauges);
  return response;
}

Response Daemon::readiness() const {
  if (draining_) throw draining();
  if (jobs_ && !jobs_->is_well()) throw jobs::store_unavailable();
  return plain(200, "ready\n");
}

Response Daemon::show_request(const Call& call) { return json_response(progress_json(*find_own(registry_, call))); }

Response Daemon::cancel_request(const Call& call) {
  find_own(registry_, call)->cancel();
  Response response;
  response.status = 204;
  return response;
}

Response Daemon::follow_request(const Call& call) {
  Response response;
  response.content_type = "text/event-stream";
  response.headers = event_stream_headers();
  response.next_piece = [this, running = find_own(registry_, call), owner = call.request.owner,
                         &connection = call.connection, next = Clock::now(), is_over = false]() mutable -> std::string {
    if (is_over || !keys_.has_owner(owner) || connection.wait(nullptr, next) == Connection::Wake::kClientGone)
      return {};
    next = Clock::now() + kProgressPeriod;
    is_over = running->has_ended;
    return sse(is_over ? "end" : "progress", progress_json(*running));
  };
  return response;
}

}  // namespace remesh::server
