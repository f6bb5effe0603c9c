/// A client that sends exactly the bytes it is told to, as no HTTP library would.
#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

namespace remesh::server {

/// How long a test waits for an event that must happen. The time is long, so that a busy machine is not mistaken for a
/// fault.
constexpr std::chrono::seconds kPatience{120};

/// An answer, split into its parts.
struct Answer {
  int status = 0;
  std::string head;
  std::string body;

  static Answer parse(const std::string& text) {
    Answer answer;
    const std::size_t end = text.find("\r\n\r\n");
    if (text.rfind("HTTP/1.1 ", 0) != 0 || end == std::string::npos) return answer;
    answer.status = std::stoi(text.substr(9, 3));
    answer.head = text.substr(0, end + 2);
    answer.body = text.substr(end + 4);
    return answer;
  }

  std::string header(const std::string& name) const {
    const std::size_t at = head.find("\r\n" + name + ": ");
    if (at == std::string::npos) return {};
    const std::size_t start = at + name.size() + 4;
    return head.substr(start, head.find("\r\n", start) - start);
  }
};

class RawClient {
 public:
  /// Connects to the server from `from`, an address of this machine.
  /// Input:  `receive_buffer` is the size of the buffer for arriving bytes; 0 leaves it to the system. With a small
  ///         buffer the client takes little, so that an answer waits at the server.
  explicit RawClient(int port, const char* from = "127.0.0.1", int receive_buffer = 0)
      : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    if (receive_buffer > 0) {
      ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &receive_buffer, sizeof receive_buffer);
      // Segments must be small, or the other side makes its buffer large.
      const int segment = 536;
      ::setsockopt(socket_, IPPROTO_TCP, TCP_MAXSEG, &segment, sizeof segment);
    }
    // The port is chosen on connecting. Otherwise each one could be used only once while old connections linger.
    const int later = 1;
    ::setsockopt(socket_, IPPROTO_IP, IP_BIND_ADDRESS_NO_PORT, &later, sizeof later);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    ::inet_pton(AF_INET, from, &address.sin_addr);
    if (::bind(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0)
      throw std::runtime_error("cannot send from there");
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0) {
      throw std::runtime_error("cannot connect");
    }
    const timeval patience{kPatience.count(), 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
  }
  ~RawClient() { close(); }
  RawClient(const RawClient&) = delete;
  RawClient& operator=(const RawClient&) = delete;

  /// Sends all bytes.
  /// Output: false if the server has closed the connection.
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t put = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (put < 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(put));
    }
    return true;
  }

  /// Returns everything up to the end of the connection. If `stop` is given and arrives, it returns what has arrived by
  /// then.
  std::string receive(std::string_view stop = {}) {
    while ((stop.empty() || arrived_.find(stop) == std::string::npos) && receive_some()) {
    }
    return std::exchange(arrived_, {});
  }

  /// Returns one answer and skips interim ones. It takes as much of the body as Content-Length says, or everything up
  /// to the end if the answer ends the connection.
  std::string receive_answer() {
    const auto take_head = [this] { return take_up_to("\r\n\r\n"); };
    std::string head = take_head();
    while (head.rfind("HTTP/1.1 1", 0) == 0) head = take_head();
    const Answer answer = Answer::parse(head);
    if (answer.header("Connection") != "keep-alive") return head + receive();
    const std::string length = answer.header("Content-Length");
    return head + (length.empty() ? "" : take(std::stoull(length)));
  }
  /// Returns the next answer, split into its parts.
  Answer answer() { return Answer::parse(receive_answer()); }

  /// Takes one byte if there is one.
  void receive_byte() {
    char byte = 0;
    [[maybe_unused]] const ssize_t got = ::recv(socket_, &byte, 1, MSG_DONTWAIT);
  }

  /// Returns whether there is something to receive, or the connection has ended.
  bool has_input() const {
    pollfd entry{socket_, POLLIN, 0};
    return ::poll(&entry, 1, 0) > 0;
  }

  /// Returns whether the server has ended the connection, and all that it sent before was received.
  bool is_ended() const { return is_ended_; }

  int socket() const { return socket_; }
  void close_sending() { ::shutdown(socket_, SHUT_WR); }
  void close() {
    if (socket_ >= 0) ::close(socket_);
    socket_ = -1;
  }

 private:
  /// Waits for some bytes and appends them to `arrived_`.
  /// Output: false at the end of the connection, or if nothing arrives within kPatience.
  bool receive_some() {
    std::array<char, 4096> buffer;
    const ssize_t got = ::recv(socket_, buffer.data(), buffer.size(), 0);
    if (got > 0) arrived_.append(buffer.data(), static_cast<std::size_t>(got));
    if (got == 0 || (got < 0 && errno != EAGAIN)) is_ended_ = true;
    return got > 0;
  }
  std::string take(std::size_t size) {
    while (arrived_.size() < size && receive_some()) {
    }
    std::string taken = arrived_.substr(0, size);
    arrived_.erase(0, size);
    return taken;
  }
  std::string take_up_to(std::string_view stop) {
    std::size_t at = 0;
    while ((at = arrived_.find(stop)) == std::string::npos && receive_some()) {
    }
    return take(at == std::string::npos ? arrived_.size() : at + stop.size());
  }

  int socket_;
  bool is_ended_ = false;
  std::string arrived_;  ///< bytes that were received and not taken yet
};

inline Answer ask(int port, std::string_view bytes) {
  RawClient client(port);
  client.send(bytes);
  return client.answer();
}

inline Answer get(int port, const std::string& path) {
  return ask(port, "GET " + path + " HTTP/1.1\r\nHost: localhost\r\n\r\n");
}

inline std::string post_text(const std::string& target, const std::string& body, const std::string& fields = "") {
  return "POST " + target + " HTTP/1.1\r\nHost: localhost\r\n" + fields +
         "Content-Length: " + std::to_string(body.size()) + "\r\n\r\n" + body;
}

inline Answer post(int port, const std::string& target, const std::string& body, const std::string& fields = "") {
  return ask(port, post_text(target, body, fields));
}

/// Waits until the condition holds, for at most kPatience.
/// Output: whether it holds.
template <typename Condition>
bool eventually(Condition condition) {
  const auto deadline = std::chrono::steady_clock::now() + kPatience;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    ::usleep(2000);
  }
  return true;
}

}  // namespace remesh::server
