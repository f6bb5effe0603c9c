#include "server/http_server.h"

#include <httplib.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <ctime>
#include <map>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include "api/quoting.h"
#include "server/http/address_counts.h"
#include "server/http/connection_places.h"
#include "server/http/connection_threads.h"
#include "server/http/error_response.h"
#include "server/http/exchange.h"
#include "server/http/large_answer.h"
#include "server/observe/log.h"
#include "server/work/request_registry.h"

namespace remesh::server {
namespace {

constexpr int kBacklog = 1024;
/// The number of threads beyond the permitted connections. They tell further clients that there is no room.
constexpr std::size_t kRefusers = 32;
/// How long a client may continue to send after an answer that came before the end of its body. Two minutes are enough
/// for 240 MB at 2 MB/s.
constexpr Connection::Linger kLinger{{std::chrono::seconds(2), 64 << 10}, std::chrono::minutes(2), 1ull << 30};
/// The same limits for a client that was refused a connection.
constexpr Connection::Linger kRefusalLinger{{}, std::chrono::milliseconds(200), 1 << 20};
constexpr Connection::Linger kNoLinger{};
/// The library matches paths with std::regex, which recurses for every character. No route is nearly this long.
constexpr std::size_t kMaxPath = 1024;

/// Gives httplib a head that this daemon wrote, and sends httplib's answer to the client. httplib writes the head and
/// the body separately. This stream buffers them, so that a small body goes in one packet with its head and wakes the
/// client once. Streamed answers are sent at once.
class ExchangeStream : public httplib::Stream {
 public:
  ExchangeStream(const Exchange& exchange, std::string head) : exchange_(exchange), head_(std::move(head)) {}

  ssize_t read(char* bytes, std::size_t size) override {
    const std::size_t count = head_.copy(bytes, size, read_);
    read_ += count;
    return static_cast<ssize_t>(count);
  }
  /// Errors: ConnectionLost, which passes through the library to the caller of `answer`.
  ssize_t write(const char* bytes, std::size_t size) override {
    constexpr std::size_t kMaxHeld = 16 << 10;
    const bool is_held = !exchange_.is_streamed && size <= kMaxHeld - held_.size();
    if (is_held) {
      held_.append(bytes, size);
    } else {
      flush();
      exchange_.connection.write_all({bytes, size});
    }
    return static_cast<ssize_t>(size);
  }
  /// Sends the buffered bytes.
  /// Errors: ConnectionLost.
  void flush() { exchange_.connection.write_all(std::exchange(held_, {})); }
  bool is_readable() const override { return true; }
  bool is_writable() const override { return true; }
  // The library would refuse descriptors that select() cannot handle, but it needs none here.
  socket_t socket() const override { return INVALID_SOCKET; }
  void get_remote_ip_and_port(std::string& ip, int& port) const override {
    ip = exchange_.connection.peer_address();
    port = 0;
  }
  void get_local_ip_and_port(std::string&, int&) const override {}

 private:
  const Exchange& exchange_;
  const std::string head_;
  std::size_t read_ = 0;
  std::string held_;
};

/// httplib passes no context of the caller to its handlers. Each thread serves one exchange at a time.
thread_local Exchange* current_exchange = nullptr;

class CurrentExchange {
 public:
  explicit CurrentExchange(Exchange& exchange) { current_exchange = &exchange; }
  ~CurrentExchange() { current_exchange = nullptr; }
  CurrentExchange(const CurrentExchange&) = delete;
  CurrentExchange& operator=(const CurrentExchange&) = delete;
};

/// Makes the head that httplib sees. It contains only the fields needed to find a route.
std::string canonical_head(const Exchange& exchange) {
  const Request& request = exchange.request;
  const std::string method = exchange.refusal && request.method != "HEAD" ? "GET" : request.method;
  const std::string path = exchange.refusal      ? "/"
                           : request.path == "*" ? "*"
                                                 : api::percent_encoded(request.path, "/-_.~");
  return method + " " + path + " HTTP/1.1\r\nHost: remeshd\r\nContent-Length: 0\r\n\r\n";
}

/// Converts the path of a route to the regular expression that httplib needs. The parameter is its only group.
std::string regex_of(std::string_view path) {
  constexpr std::string_view kParameter = "{id}";
  std::string regex;
  while (!path.empty()) {
    if (path.substr(0, kParameter.size()) == kParameter) {
      regex += "([^/]+)";
      path.remove_prefix(kParameter.size());
      continue;
    }
    if (std::string_view(".*+?()[]{}|^$\\").find(path.front()) != std::string_view::npos) regex += '\\';
    regex += path.front();
    path.remove_prefix(1);
  }
  return regex;
}

HttpError not_found(const std::string& near = {}) {
  return HttpError(404, "not_found",
                   near.empty()
                       ? std::string("there is nothing at this path; /openapi.json lists all paths")
                       : "there is nothing at this path; without the slash at the end, the path would be " + near);
}

std::string http_date() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  ::gmtime_r(&now, &utc);
  std::array<char, 64> text{};
  std::strftime(text.data(), text.size(), "%a, %d %b %Y %H:%M:%S GMT",
                &utc);  // no locale is ever set, so this is the C locale
  return text.data();
}

/// Makes a field's value unable to break out of its line: control characters become blanks.
std::string one_line(std::string value) {
  for (char& c : value) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  }
  return value;
}

std::string name_request(const RequestHead& head) {
  const std::string_view sent = head.header("x-request-id");
  return is_request_id(sent) ? std::string(sent) : new_request_id();
}

}  // namespace

class HttpServer::Listener : public httplib::Server {
 public:
  Listener(const std::vector<Route>& routes, const HttpSettings& settings)
      : settings_(settings),
        addresses_(settings.connections.max_connections_per_address),
        key_limits_(settings.key_rules),
        places_(settings.connections.max_connections) {
    set_default_headers({{"X-Content-Type-Options", "nosniff"}});
    set_payload_max_length(0);  // bodies do not pass through the library
    register_routes(routes);
    register_ways_out();
    new_task_queue = [this] {
      // A connection whose wait was ended keeps its thread until it has noticed that.
      return new ConnectionThreads(2 * settings_.connections.max_connections + kRefusers,
                                   [this] { places_.end_all(); });
    };
    // With the library's own socket options, two daemons could share a port unnoticed.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
  }

  ~Listener() override {
    if (spare_ >= 0) ::close(spare_);
  }

  void bind(const Address& address) {
    errno = 0;
    port_ = address.port != 0 ? address.port : -1;
    if (address.port == 0) {
      port_ = bind_to_any_port(address.host);
    } else if (!bind_to_port(address.host, address.port)) {
      port_ = -1;
    }
    // listen() is called again for a backlog that holds a burst of clients; the library's backlog is 5.
    if (port_ < 0 || ::listen(svr_sock_, kBacklog) != 0) {
      const std::string reason = errno != 0 ? std::strerror(errno) : "the address is not known";
      throw std::runtime_error("cannot listen on " + address.text() + ": " + reason);
    }
    spare_ = ::dup(svr_sock_);
  }

  void start() {
    thread_ = std::thread([this] { accept_connections(); });
    while (!is_running()) std::this_thread::yield();
  }

  void begin_drain() {
    draining_ = true;
    places_.end_all();
  }

  void stop_all() {
    if (!thread_.joinable()) return;
    stopping_ = true;
    begin_drain();
    {
      const std::lock_guard lock(mutex_);
      for (const int socket : sockets_) ::shutdown(socket, SHUT_RDWR);
    }
    // This makes accept() fail, and the library closes its own descriptor in its own thread. The library's stop()
    // would close it in this thread, when the number may already belong to another connection.
    ::shutdown(spare_, SHUT_RDWR);
    thread_.join();
  }

  int port() const { return port_; }
  std::size_t active_requests() const { return active_; }
  std::size_t open_connections() const { return places_.served() + places_.waiting(); }

 private:
  void accept_connections() {
    listener_thread_ = std::this_thread::get_id();
    // The library ends its loop and closes the socket after any unknown error of accept(). A second descriptor of the
    // socket lets the loop begin again.
    while (!listen_once() && !stopping_) {
      log::write(log::Level::kWarning, "accept failed, listening again", {});
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      svr_sock_ = ::dup(spare_);
      places_.begin_again();
      if (draining_) places_.end_all();
    }
  }

  /// Output: false if the library gave up and closed the socket.
  bool listen_once() {
    try {
      return listen_after_bind();
    } catch (const std::exception&) {
      return false;
    }
  }

  bool process_and_close_socket(socket_t socket) override {
    std::optional<Connection> accepted;
    try {
      Connection& connection = accepted.emplace(socket, &ahead_);
      const OpenSocket registered(*this, socket);
      std::optional<Event> end;
      while (admit(connection) && has_next(connection, end)) connection.begin_exchange();
    } catch (const std::exception& error) {
      log::write(log::Level::kError, "connection failed", {{"error", std::string(error.what())}});
      if (accepted) excuse(*accepted);
    }
    return true;
  }

  /// Serves one request if there is room for another connection.
  /// Output: true if the connection stays open.
  bool admit(Connection& connection) {
    const bool is_here = std::this_thread::get_id() == listener_thread_;
    const std::optional<ConnectionPlaces::Served> served = is_here ? std::nullopt : places_.enter();
    if (!served) {
      refuse(connection, HttpError(503, "overloaded", "too many connections"));
      return false;
    }
    if (settings_.proxies.contains(connection.peer_address())) return serve(connection);
    const std::optional<AddressCounts::Place> counted = addresses_.enter(connection.peer_address());
    if (!counted) {
      refuse(connection, too_many());
      return false;
    }
    return serve(connection);
  }

  HttpError too_many() const {
    return HttpError(429, "rate_limited", "too many connections from this address")
        .with_limit(settings_.connections.max_connections_per_address);
  }

  /// Reads the client's address from the fields of a trusted proxy. The proxy's own connections have no limit, so each
  /// client behind it is counted while it is served.
  /// Errors: HttpError 429.
  void heed_proxy(Exchange& exchange) {
    Request& request = exchange.request;
    request.prefix = settings_.public_url.prefix();
    if (!settings_.proxies.contains(exchange.client)) return;
    std::string_view prefix = request.header("x-forwarded-prefix");
    if (prefix.ends_with('/')) prefix.remove_suffix(1);
    if (is_path_prefix(prefix)) request.prefix = prefix;
    // All clients that a proxy hides count as one, so that hiding is no way around the limit.
    const bool is_hidden = is_client_hidden(request, exchange.client, settings_.proxies);
    exchange.client = client_address(request, exchange.client, settings_.proxies);
    if (settings_.proxies.contains(exchange.client) && !is_hidden) return;
    exchange.place = addresses_.enter(exchange.client);
    if (!exchange.place) throw too_many();
  }

  /// Waits for the next request on a connection that stays open. Some clients send a line end after a body, which
  /// belongs to no request and is skipped (RFC 9112, section 2.2).
  bool has_next(Connection& connection, std::optional<Event>& end) {
    const auto is_there = [&] {
      connection.skip_line_end();
      return connection.has_unread_input();
    };
    if (is_there()) return true;
    if (!end) end.emplace();
    const ConnectionPlaces::Wait wait(places_, *end);
    const Clock::time_point until = Clock::now() + settings_.connections.idle_timeout;
    return connection.wait_for_input(*end, until) && (is_there() || connection.wait_for_input(*end, until));
  }

  /// Sends a fixed answer as a last resort, when there is not even memory for a proper one.
  static void excuse(Connection& connection) {
    if (connection.bytes_written() > 0) return;
    try {
      connection.write_all(
          "HTTP/1.1 503 Service Unavailable\r\nContent-Type: application/problem+json\r\nRetry-After: 2\r\n"
          "Connection: close\r\n\r\n"
          "{\"type\":\"urn:remeshd:problem:out_of_memory\",\"title\":\"Out of memory\",\"status\":503,"
          "\"detail\":\"not enough memory for this request now\",\"code\":\"out_of_memory\"}\n");
      connection.finish(kRefusalLinger, [] { return true; });
    } catch (const ConnectionLost&) {
    }
  }

  void refuse(Connection& connection, const HttpError& reason) {
    Exchange exchange(connection);
    exchange.request.id = new_request_id();
    exchange.refusal = std::make_exception_ptr(reason);
    try {
      answer(exchange);
    } catch (const ConnectionLost&) {
      return account_for(exchange, Outcome::kClientGone, settings_.metrics);
    }
    account_for(exchange, Outcome::kAnswered, settings_.metrics);
    const bool has_time = std::this_thread::get_id() != listener_thread_ && may_linger();
    connection.finish(has_time ? kRefusalLinger : kNoLinger, [this] { return may_linger(); });
  }

  /// Serves one request.
  /// Output: true if the connection stays open.
  bool serve(Connection& connection) {
    connection.set_write_pace({settings_.connections.gate.write_timeout, settings_.connections.gate.min_body_rate});
    Exchange exchange(connection);
    try {
      if (!take_head(exchange)) return false;
      answer(exchange);
    } catch (const ConnectionLost&) {
      account_for(exchange, Outcome::kClientGone, settings_.metrics);
      return false;
    }
    account_for(exchange, Outcome::kAnswered, settings_.metrics);
    if (exchange.is_kept) return true;
    exchange.active.reset();
    exchange.request.memory.reset();
    // A client whose whole request was read usually has nothing more to send. Any other client may be in the middle
    // of its upload.
    const bool is_silent = exchange.is_read && !connection.has_unread_input();
    connection.finish(is_silent ? kNoLinger : kLinger, [this] { return may_linger(); });
    return false;
  }

  /// True if a connection may continue to read and drop what its client sends. This occupies a thread, and many refused
  /// clients must not take the threads of other clients, nor delay the end of the process.
  bool may_linger() const {
    return !draining_ && places_.served() <= settings_.connections.max_connections / 2 + kRefusers / 2;
  }

  /// Output: false if there is no request.
  bool take_head(Exchange& exchange) {
    RequestHead& head = exchange.request;
    try {
      const std::optional<Framing> framing = read_head(exchange.connection, settings_.connections.gate, head);
      if (!framing) return false;
      exchange.framing = *framing;
      heed_proxy(exchange);
      if (settings_.sites) settings_.sites->check(head, access_of(head.path));
      check_routable(head);
    } catch (const ConnectionLost&) {
      throw;
    } catch (...) {
      exchange.refusal = std::current_exception();
    }
    exchange.request.id = name_request(head);
    return true;
  }

  Access access_of(const std::string& path) const {
    const auto known = open_paths_.find(path);
    return known == open_paths_.end() ? Access::kGuarded : known->second;
  }

  static void check_routable(const RequestHead& head) {
    static const std::set<std::string> methods{"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"};
    if (methods.count(head.method) == 0)
      throw HttpError(501, "not_implemented",
                      "this server does not support "
                      "the request method");
    if (head.path.size() > kMaxPath) throw not_found();
  }

  /// Lets httplib route the request and write the answer.
  /// Errors: ConnectionLost.
  void answer(Exchange& exchange) {
    const CurrentExchange current(exchange);
    ExchangeStream stream(exchange, canonical_head(exchange));
    bool is_closed = false;
    if (!process_request(stream, /*close_connection=*/false, is_closed, nullptr)) exchange.is_kept = false;
    stream.flush();
    if (exchange.large_body.empty() || exchange.request.method == "HEAD") return;
    send_large(exchange.connection, std::move(exchange.large_body), *settings_.spool,
               [&] { exchange.request.memory.reset(); });
  }

  /// True if the connection may serve another request: the client permits it and has done nothing wrong, and both
  /// sides know where this exchange ends. If a body was not read, or an answer has no length, the exchange ends with
  /// the connection.
  bool may_keep(const Exchange& exchange) const {
    return exchange.is_read && exchange.status < 400 && !exchange.is_streamed &&
           settings_.connections.idle_timeout.count() > 0 && !places_.is_over() && wants_to_be_kept(exchange.request);
  }

  /// Asks a route for admission of a request, and reads the request's body if there is one.
  /// Output: the place of a request with work among those of its API key, if there is a limit. The place must end
  ///         before the answer is sent, so that a client which has its answer may send the next request at once.
  [[nodiscard]] std::optional<AddressCounts::Place> take_in(Exchange& exchange, const Route& route) {
    exchange.route = route.path;
    identify(exchange.request, route);
    std::optional<AddressCounts::Place> place;
    if (route.admit && !exchange.request.key.empty()) place = key_limits_.enter(exchange.request.owner, Clock::now());
    const Admission admission = route.admit ? route.admit(exchange.request) : Admission{};
    exchange.request.memory = admission.memory;
    take_body(exchange, admission.max_body);
    return place;
  }

  /// Determines the owner of this request, and the name of its API key.
  /// Errors: HttpError 401.
  void identify(Request& request, const Route& route) const {
    if (settings_.keys == nullptr) return;
    find_owner(request, route);
    request.key = settings_.keys->name_of(request.owner);
  }

  void find_owner(Request& request, const Route& route) const {
    request.owner = settings_.keys->owner(request);
    if (route.access != Access::kGuarded || settings_.keys->admits(request)) return;
    std::optional<std::string> owner;
    if (route.takes_token) {
      const auto shown = std::find_if(request.query.begin(), request.query.end(),
                                      [](const auto& parameter) { return parameter.first == "token"; });
      const auto now = std::chrono::system_clock::now();
      if (shown != request.query.end()) owner = settings_.keys->owner_by_token(shown->second, request.path, now);
    }
    if (!owner) {
      throw HttpError(401, "unauthorized", "an API key is required: send it as Authorization: Bearer KEY")
          .with_header("WWW-Authenticate", "Bearer");
    }
    request.owner = *owner;
  }

  void take_body(Exchange& exchange, std::uint64_t max_body) {
    const Clock::time_point start = Clock::now();
    Request& request = exchange.request;
    exchange.active.emplace(active_);
    request.body = read_body(exchange.connection, settings_.connections.gate, request, exchange.framing, max_body,
                             [&](std::uint64_t held, std::uint64_t expected) {
                               if (request.memory)
                                 hold_body_in_line(*request.memory, held, expected, request, exchange.connection,
                                                   settings_.memory_patience);
                             });
    exchange.is_read = true;
    request.timing.body = milliseconds_between(start, Clock::now());
  }

  /// Gives the answer to httplib, which writes it.
  void give(Exchange& exchange, Response answer, httplib::Response& out) const {
    exchange.status = answer.status;
    exchange.problem_code = std::move(answer.problem_code);
    exchange.job = std::move(answer.job);
    exchange.is_told = answer.is_told;
    exchange.done = std::move(answer.done);
    out.status = answer.status;
    out.set_header("Date", http_date());
    out.set_header("X-Request-Id", exchange.request.id);
    for (const auto& [name, value] : answer.headers) {
      out.set_header(name, one_line(value));
      if (name == "Accept-Ranges") exchange.takes_ranges = true;
    }
    for (const auto& [name, value] : settings_.cors.headers(exchange.request)) out.set_header(name, value);
    const std::string content_type = one_line(answer.content_type);
    if (answer.next_piece) {
      exchange.is_streamed = true;
      out.set_content_provider(content_type,
                               [next = std::move(answer.next_piece)](std::size_t, httplib::DataSink& sink) {
                                 const std::string piece = next();
                                 if (!piece.empty()) return sink.write(piece.data(), piece.size());
                                 sink.done();
                                 return true;
                               });
      return;
    }
    if (!content_type.empty()) out.set_header("Content-Type", content_type);
    if (answer.size_for_head) {
      out.set_header("Content-Length", std::to_string(*answer.size_for_head));
    } else if (settings_.spool != nullptr && answer.body.size() > kLargeAnswer) {
      // For HEAD, the library writes the head alone.
      out.set_header("Content-Length", std::to_string(answer.body.size()));
      exchange.large_body = std::move(answer.body);
    } else {
      out.body = std::move(answer.body);  // set_content would copy it
    }
  }

  void give_failure(Exchange& exchange, const std::exception_ptr& failure, httplib::Response& out) const {
    give(exchange, error_response(failure, exchange.request.id), out);
  }

  void register_routes(const std::vector<Route>& routes) {
    for (const Route& route : routes) {
      if (route.access != Access::kGuarded) open_paths_.emplace(route.path, route.access);
      on(route.method, regex_of(route.path), [this, route](const httplib::Request& routed, httplib::Response& out) {
        Exchange& exchange = *current_exchange;
        const std::optional<AddressCounts::Place> place = take_in(exchange, route);
        const std::string parameter = routed.matches.size() > 1 ? routed.matches[1].str() : "";
        give(exchange, route.handle({exchange.request, exchange.connection, parameter}), out);
      });
      if (paths_.insert(route.path).second) register_other_methods(routes, route.path);
    }
    register_options("*", "OPTIONS");
  }

  /// Registers the answers to methods that have no route at a path.
  void register_other_methods(const std::vector<Route>& routes, const std::string& path) {
    std::set<std::string> others{"GET", "POST", "PUT", "PATCH", "DELETE"};
    std::string allow;
    for (const Route& route : routes) {
      if (route.path != path) continue;
      allow += route.method == "GET" ? "GET, HEAD, " : route.method + ", ";
      others.erase(route.method);
    }
    allow += "OPTIONS";
    for (const std::string& method : others) {
      on(method, regex_of(path), [allow, path](const httplib::Request&, httplib::Response&) {
        current_exchange->route = path;
        throw HttpError(405, "method_not_allowed", "this path takes " + allow).with_header("Allow", allow);
      });
    }
    register_options(path, allow);
  }

  void register_options(const std::string& path, const std::string& allow) {
    on("OPTIONS", regex_of(path), [this, path, allow](const httplib::Request&, httplib::Response& out) {
      Exchange& exchange = *current_exchange;
      exchange.route = path;
      take_body(exchange, 0);
      Response response;
      response.status = 204;
      response.headers.emplace_back("Allow", allow);
      give(exchange, std::move(response), out);
      for (const auto& [name, value] : settings_.cors.headers(exchange.request, allow)) {
        if (!out.has_header(name)) out.set_header(name, value);
      }
    });
  }

  void on(const std::string& method, const std::string& regex, httplib::Server::Handler handler) {
    if (method == "GET") {
      Get(regex, std::move(handler));
    } else if (method == "POST") {
      Post(regex, std::move(handler));
    } else if (method == "PUT") {
      Put(regex, std::move(handler));
    } else if (method == "PATCH") {
      Patch(regex, std::move(handler));
    } else if (method == "DELETE") {
      Delete(regex, std::move(handler));
    } else if (method == "OPTIONS") {
      Options(regex, std::move(handler));
    } else {
      throw std::logic_error("no route can have the method " + method);
    }
  }

  /// The path without a superfluous slash at its end.
  /// Output: empty if there is no route at that path.
  std::string nearby(const Request& request) const {
    if (!request.path.ends_with('/')) return {};
    const std::string path = request.path.substr(0, request.path.size() - 1);
    return paths_.count(path) > 0 ? request.prefix + path : std::string();
  }

  /// Registers the handlers for requests that no route has answered, and for the last changes to every answer.
  void register_ways_out() {
    using Handled = httplib::Server::HandlerResponse;
    set_pre_routing_handler([](const httplib::Request&, httplib::Response&) {
      if (current_exchange->refusal) std::rethrow_exception(current_exchange->refusal);
      return Handled::Unhandled;
    });
    set_exception_handler([this](const httplib::Request&, httplib::Response& out, const std::exception_ptr& failure) {
      try {
        std::rethrow_exception(failure);
      } catch (const ConnectionLost&) {
        throw;  // there is no client left to answer
      } catch (...) {
        give_failure(*current_exchange, failure, out);
      }
    });
    // The library calls this for every status from 400 on, also for those that a route has set.
    set_error_handler(httplib::Server::HandlerWithResponse([this](const httplib::Request&, httplib::Response& out) {
      if (current_exchange->status != 0) return Handled::Unhandled;
      give_failure(*current_exchange, std::make_exception_ptr(not_found(nearby(current_exchange->request))), out);
      return Handled::Handled;
    }));
    set_post_routing_handler([this](const httplib::Request&, httplib::Response& out) {
      Exchange& exchange = *current_exchange;
      exchange.is_kept = may_keep(exchange);
      out.headers.erase("Keep-Alive");  // the library has written its own times
      out.set_header("Connection", exchange.is_kept ? "keep-alive" : "close");
      const auto seconds = std::chrono::floor<std::chrono::seconds>(told_idle_timeout(settings_.connections)).count();
      if (exchange.is_kept && seconds > 0) out.set_header("Keep-Alive", "timeout=" + std::to_string(seconds));
      out.headers.erase("Accept-Ranges");  // the library's own
      if (exchange.takes_ranges) out.set_header("Accept-Ranges", "bytes");
      if (out.status == 204 || out.status == 304) out.headers.erase("Content-Length");
    });
  }

  /// Registers the socket of an open connection, so that `stop_all` can find it.
  class OpenSocket {
   public:
    OpenSocket(Listener& listener, int socket) : listener_(listener), socket_(socket) {
      const std::lock_guard lock(listener_.mutex_);
      listener_.sockets_.insert(socket_);
      if (listener_.stopping_) ::shutdown(socket_, SHUT_RDWR);
    }
    ~OpenSocket() {
      const std::lock_guard lock(listener_.mutex_);
      listener_.sockets_.erase(socket_);
    }
    OpenSocket(const OpenSocket&) = delete;
    OpenSocket& operator=(const OpenSocket&) = delete;

   private:
    Listener& listener_;
    int socket_;
  };

  const HttpSettings settings_;
  std::set<std::string> paths_;               ///< of all routes, with `{id}` for the variable part
  std::map<std::string, Access> open_paths_;  ///< the paths that everyone may use
  AddressCounts addresses_;
  KeyLimits key_limits_;
  int port_ = -1;
  int spare_ = -1;  ///< a second descriptor of the listening socket
  std::thread thread_;
  std::atomic<std::thread::id> listener_thread_{};
  std::atomic<bool> stopping_{false};
  std::atomic<bool> draining_{false};
  ReadAhead ahead_;
  ConnectionPlaces places_;
  std::atomic<std::size_t> active_{0};
  std::mutex mutex_;
  std::set<int> sockets_;
};

HttpServer::HttpServer(const std::vector<Route>& routes, const HttpSettings& settings)
    : listener_(std::make_unique<Listener>(routes, settings)) {}
HttpServer::~HttpServer() { stop(); }
void HttpServer::bind(const Address& address) { listener_->bind(address); }
int HttpServer::port() const { return listener_->port(); }
void HttpServer::start() { listener_->start(); }
void HttpServer::begin_drain() { listener_->begin_drain(); }
void HttpServer::stop() { listener_->stop_all(); }
std::size_t HttpServer::active_requests() const { return listener_->active_requests(); }
std::size_t HttpServer::open_connections() const { return listener_->open_connections(); }

int probe(const Address& address, const std::string& path) {
  httplib::Client client(address.host, address.port);
  client.set_connection_timeout(2);
  client.set_read_timeout(2);
  const httplib::Result result = client.Get(path);
  return result ? result->status : 0;
}

}  // namespace remesh::server
