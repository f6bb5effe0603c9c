#include "server/http_server.h"

#include <httplib.h>
#include <sys/socket.h>

#include <atomic>
#include <cerrno>
#include <condition_variable>
#include <cstring>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>

#include "server/error_response.h"
#include "server/log.h"
#include "server/request_registry.h"
#include "server/response_writer.h"

namespace remesh::server {
namespace {

constexpr int kBacklog = 1024;
/// Threads beyond the connections allowed, which tell the others that there is no room.
constexpr std::size_t kRefusers = 32;
/// How long a client may go on sending after its refusal.
constexpr std::chrono::milliseconds kLinger{2000};
constexpr std::chrono::milliseconds kRefusalLinger{200};

/// A thread a connection: a slow client holds nothing but its own.
class ConnectionThreads : public httplib::TaskQueue {
 public:
  explicit ConnectionThreads(std::size_t max_threads) : max_threads_(max_threads) {}

  void enqueue(std::function<void()> serve) override {
    {
      const std::lock_guard lock(mutex_);
      if (running_ >= max_threads_) return serve();  // in the listener's thread, which only refuses
      ++running_;
    }
    try {
      std::thread([this, serve] {
        serve();
        leave();
      }).detach();
    } catch (const std::system_error&) {
      leave();
      serve();
    }
  }

  void shutdown() override {
    std::unique_lock lock(mutex_);
    idle_.wait(lock, [this] { return running_ == 0; });
  }

 private:
  void leave() {
    // Told under the lock: once `shutdown` returns, this object is gone.
    const std::lock_guard lock(mutex_);
    --running_;
    idle_.notify_all();
  }

  const std::size_t max_threads_;
  std::mutex mutex_;
  std::condition_variable idle_;
  std::size_t running_ = 0;
};

/// Counts up for the time of a scope.
class Counted {
 public:
  explicit Counted(std::atomic<std::size_t>& counter) : counter_(counter) { ++counter_; }
  ~Counted() { --counter_; }
  Counted(const Counted&) = delete;
  Counted& operator=(const Counted&) = delete;

 private:
  std::atomic<std::size_t>& counter_;
};

std::string name_request(const RequestHead& head) {
  const std::string_view sent = head.header("x-request-id");
  return is_request_id(sent) ? std::string(sent) : new_request_id();
}

void log_access(const Connection& connection, const Request& request, int status, Clock::time_point start,
                const char* outcome) {
  const bool is_probe = request.path == "/livez" || request.path == "/readyz";
  log::write(is_probe ? log::Level::kDebug : log::Level::kInfo, "request",
             {{"id", request.id},
              {"method", request.method},
              {"path", request.path},
              {"status", std::int64_t{status}},
              {"bytes_in", static_cast<std::int64_t>(connection.bytes_read())},
              {"bytes_out", static_cast<std::int64_t>(connection.bytes_written())},
              {"ms", std::chrono::duration<double, std::milli>(Clock::now() - start).count()},
              {"peer", connection.peer_address()},
              {"outcome", std::string(outcome)}});
}

}  // namespace

class HttpServer::Listener : public httplib::Server {
 public:
  Listener(const Router& router, const GateLimits& limits, std::size_t max_connections)
      : router_(router), limits_(limits), max_connections_(max_connections) {
    new_task_queue = [this] { return new ConnectionThreads(max_connections_ + kRefusers); };
    // The library's own options let two daemons share a port in silence.
    set_socket_options([](socket_t socket) {
      const int yes = 1;
      ::setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    });
  }

  void bind(const Address& address) {
    errno = 0;
    port_ = address.port != 0 ? address.port : -1;
    if (address.port == 0) {
      port_ = bind_to_any_port(address.host);
    } else if (!bind_to_port(address.host, address.port)) {
      port_ = -1;
    }
    // Once more for a backlog that a burst of clients fits in: the library's is 5.
    if (port_ < 0 || ::listen(svr_sock_, kBacklog) != 0) {
      const std::string reason = errno != 0 ? std::strerror(errno) : "the address is not known";
      throw std::runtime_error("cannot listen on " + address.text() + ": " + reason);
    }
  }

  void start() {
    accepting_ = true;
    thread_ = std::thread([this] { accept_connections(); });
    while (!is_running()) std::this_thread::yield();
  }

  void stop_all() {
    if (!thread_.joinable()) return;
    stopping_ = true;
    {
      const std::lock_guard lock(mutex_);
      for (const int socket : sockets_) ::shutdown(socket, SHUT_RDWR);
    }
    // Again and again: the library forgets a stop that comes while it is not in its loop.
    while (accepting_) {
      if (svr_sock_ != INVALID_SOCKET) stop();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    thread_.join();
  }

  int port() const { return port_; }
  std::size_t active_requests() const { return active_; }

 private:
  void accept_connections() {
    listener_thread_ = std::this_thread::get_id();
    // The library ends its loop on any error of accept() that it does not know, and closes the socket: a second
    // descriptor for it lets the loop begin again.
    const int spare = ::dup(svr_sock_);
    while (!listen_after_bind() && !stopping_) {
      log::write(log::Level::kWarning, "accept failed, listening again", {});
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      svr_sock_ = ::dup(spare);
    }
    ::close(spare);
    accepting_ = false;
  }

  bool process_and_close_socket(socket_t socket) override {
    try {
      Connection connection(socket);
      const Counted open(open_);
      if (std::this_thread::get_id() == listener_thread_ || open_ > max_connections_) {
        refuse(connection);
        return true;
      }
      const OpenSocket registered(*this, socket);
      serve(connection);
    } catch (const std::exception& error) {
      log::write(log::Level::kError, "connection failed", {{"error", std::string(error.what())}});
    }
    return true;
  }

  void refuse(Connection& connection) {
    Request nobody;
    nobody.id = new_request_id();
    const HttpError error(503, "overloaded", "too many connections");
    try {
      send_response(connection, nobody, error_response(std::make_exception_ptr(error), nobody.id));
    } catch (const ConnectionLost&) {
      return;
    }
    const bool is_listener = std::this_thread::get_id() == listener_thread_;
    connection.finish(is_listener ? std::chrono::milliseconds(0) : kRefusalLinger);
  }

  /// One connection: one request, one answer.
  void serve(Connection& connection) {
    const Clock::time_point start = Clock::now();
    connection.set_write_pace({limits_.write_timeout, limits_.min_body_rate});
    Request request;
    Response response;
    std::unique_ptr<Counted> active;
    bool is_read = false;
    try {
      const auto admit = [&](const RequestHead& head) {
        const std::uint64_t max_body = router_.admit(head);
        active = std::make_unique<Counted>(active_);
        return max_body;
      };
      if (!read_request(connection, limits_, name_request, admit, request)) return;
      is_read = true;
      response = router_.answer(request, connection);
    } catch (const ConnectionLost&) {
      log_access(connection, request, 0, start, "client_gone");
      return;
    } catch (...) {
      if (request.id.empty()) request.id = new_request_id();
      response = error_response(std::current_exception(), request.id);
    }
    try {
      send_response(connection, request, response);
      log_access(connection, request, response.status, start, "answered");
    } catch (const ConnectionLost&) {
      log_access(connection, request, response.status, start, "client_gone");
      return;
    }
    active.reset();
    // A client whose request was read whole mostly has nothing more to say; any other may be in the middle of its
    // upload.
    const bool is_silent = is_read && !connection.has_unread_input();
    connection.finish(is_silent ? std::chrono::milliseconds(0) : kLinger);
  }

  /// Lets `stop_all` find the sockets of connections that are open.
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

  const Router& router_;
  const GateLimits limits_;
  const std::size_t max_connections_;
  int port_ = -1;
  std::thread thread_;
  std::atomic<std::thread::id> listener_thread_{};
  std::atomic<bool> accepting_{false};
  std::atomic<bool> stopping_{false};
  std::atomic<std::size_t> open_{0};
  std::atomic<std::size_t> active_{0};
  std::mutex mutex_;
  std::set<int> sockets_;
};

HttpServer::HttpServer(const Router& router, const GateLimits& limits, std::size_t max_connections)
    : listener_(std::make_unique<Listener>(router, limits, max_connections)) {}
HttpServer::~HttpServer() { stop(); }
void HttpServer::bind(const Address& address) { listener_->bind(address); }
int HttpServer::port() const { return listener_->port(); }
void HttpServer::start() { listener_->start(); }
void HttpServer::stop() { listener_->stop_all(); }
std::size_t HttpServer::active_requests() const { return listener_->active_requests(); }

int probe(const Address& address, const std::string& path) {
  httplib::Client client(address.host, address.port);
  client.set_connection_timeout(2);
  client.set_read_timeout(2);
  const httplib::Result result = client.Get(path.c_str());
  return result ? result->status : 0;
}

}  // namespace remesh::server
