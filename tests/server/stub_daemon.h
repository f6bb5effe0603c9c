/// Runs the whole daemon in this process, on a free port, with a stub in place of the geometry.
#pragma once

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <string>
#include <thread>
#include <vector>

#include "server/daemon.h"
#include "tests/server/raw_client.h"

namespace remesh::server {

using std::chrono::milliseconds;

inline std::string code_of(const Answer& answer) {
  if (answer.header("Content-Type") != "application/problem+json") return "";
  const auto problem = nlohmann::json::parse(answer.body, nullptr, false);
  return problem.is_object() ? problem.value("code", "") : "";
}

/// Does what the body says. "block" blocks until the stub is released or told to stop, and "deaf" blocks until it is
/// released only. "hungry" takes 512 MiB the first time, a little at a time, and ends when it is told to stop. "throw",
/// "no memory", "line 3" and an empty body end with an error each. For any other body, the answer describes the
/// request.
class Stub {
 public:
  api::Response operator()(const api::Request& request, const api::Limits&, RunControl& control) {
    ++calls;
    const std::string_view body = request.body;
    if (body.empty()) throw Error(Code::kEmptyMesh, Stage::kRead, "the body is empty");
    if (body == "throw") throw std::runtime_error("a secret of the server");
    if (body == "no memory") throw std::bad_alloc();
    if (body == "line 3") throw Error(Code::kInvalidMesh, Stage::kRead, "no number").at_line(3);
    if (body == "block" || body == "deaf") {
      ++blocked;
      control.enter(Stage::kTriangulation);
      control.progress(0.5);
      while (!released) {
        std::this_thread::sleep_for(milliseconds(2));
        if (body == "deaf" || !control.is_stopped()) continue;
        ++stopped;
        control.check();
      }
    }
    if (body == "hungry" && hungry++ == 0) {
      std::vector<std::string> much;
      while (!released) {
        if (much.size() < 512) much.emplace_back(1 << 20, 'x');
        if (much.size() == 512) std::this_thread::sleep_for(milliseconds(2));
        if (!control.is_stopped()) continue;
        ++stopped;
        control.check();
      }
    }
    api::Response response;
    response.content_type = "model/obj";
    response.body = std::to_string(body.size()) + " " + request.content_type + " " + request.accept;
    for (const auto& [name, value] : request.query) response.body += " " + name + "=" + value;
    return response;
  }

  std::atomic<int> calls{0}, blocked{0}, stopped{0}, hungry{0};
  std::atomic<bool> released{false};
};

class StubDaemon : public ::testing::Test {
 protected:
  StubDaemon() {
    config_.bind.port = 0;
    config_.limits.workers = 1;
    config_.max_running = 1;
    config_.limits.queue = {.max_large = 1, .max_small_bytes = 5};  // "block" has as many
    config_.limits.max_body = 1000;
  }
  ~StubDaemon() override { stub_.released = true; }

  void start() {
    log::set_up(log::Format::kText, log::Level::kError);
    Operations operations;
    operations.remesh = std::ref(stub_);
    operations.analyze = std::ref(stub_);
    operations.compare = std::ref(stub_);
    operations.capabilities = [](const api::Limits& limits) {
      return api::Response{200, "application/json", std::to_string(limits.max_body), {}};
    };
    operations.openapi = [this] { return api::Response{200, "application/json", openapi_, {}}; };
    daemon_ = std::make_unique<Daemon>(config_, std::move(operations));
    daemon_->start();
    port_ = daemon_->port();
  }
  /// Sends a request that blocks until the stub is released. Returns once it computes.
  std::unique_ptr<RawClient> start_blocking(const std::string& fields = "", const std::string& body = "block") {
    const int before = stub_.blocked;
    auto client = std::make_unique<RawClient>(port_);
    client->send(post_text("/v1/remesh", body, fields));
    EXPECT_TRUE(eventually([&] { return stub_.blocked > before; }));
    return client;
  }
  /// Opens a connection that occupies a place and stays there. The server has asked for its body, which never comes.
  std::unique_ptr<RawClient> hold_connection() {
    auto client = std::make_unique<RawClient>(port_);
    client->send("POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1\r\nExpect: 100-continue\r\n\r\n");
    EXPECT_EQ(client->receive("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
    return client;
  }
  void expect_well() {
    const Answer answer = post(port_, "/v1/remesh", "good");
    EXPECT_EQ(answer.status, 200);
  }

  Config config_;
  Stub stub_;
  std::string openapi_ = "{}";  ///< the contract that it serves
  std::unique_ptr<Daemon> daemon_;
  int port_ = 0;
};

inline const std::string kId = "abcdefgh-12345678";
inline const std::string kIdField = "X-Request-Id: " + kId + "\r\n";

}  // namespace remesh::server
