#include "server/web_page.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>

#include "core/io/gzip.h"
#include "server/http_server.h"
#include "server/observe/log.h"
#include "tests/server/raw_client.h"

namespace remesh::server {
namespace {

const std::string kScript = "const answer = 42; " + std::string(5000, '/');

std::string unpacked(const std::string& bytes) {
  RunControl control;
  return gunzip(bytes, {}, control);
}

class web_page : public ::testing::Test {
 protected:
  web_page() {
    log::set_up(log::Format::kText, log::Level::kError);
    RunControl control;
    packed_ = remesh::gzip(kScript, control);
    serve({{"/", "text/html; charset=utf-8", "<!doctype html>"},
           {"/assets/app-0123.js", "text/javascript", packed_, /*is_packed=*/true, /*is_fixed=*/true}});
  }

  void serve(const std::vector<WebFile>& files) {
    server_ = std::make_unique<HttpServer>(web_routes(files), HttpSettings{});
    server_->bind({"127.0.0.1", 0});
    server_->start();
  }
  Answer get(const std::string& path, const std::string& fields = "") const {
    return ask(server_->port(), "GET " + path + " HTTP/1.1\r\nHost: localhost\r\n" + fields + "\r\n");
  }

  std::string packed_;
  std::unique_ptr<HttpServer> server_;
};

TEST_F(web_page, a_file_comes_packed_to_who_takes_that_and_plain_to_others) {
  const Answer packed = get("/assets/app-0123.js", "Accept-Encoding: br, gzip\r\n");
  EXPECT_EQ(packed.header("Content-Encoding"), "gzip");
  EXPECT_EQ(unpacked(packed.body), kScript);
  const Answer plain = get("/assets/app-0123.js");
  EXPECT_EQ(plain.header("Content-Encoding"), "");
  EXPECT_EQ(plain.body, kScript);
  for (const Answer& answer : {packed, plain}) {
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.header("Content-Type"), "text/javascript");
    EXPECT_EQ(answer.header("Vary"), "Accept-Encoding");
  }
  EXPECT_EQ(get("/").body, "<!doctype html>");
}

TEST_F(web_page, what_has_not_changed_is_not_sent_again) {
  const std::string tag = get("/").header("ETag");
  EXPECT_NE(tag, get("/assets/app-0123.js").header("ETag"));
  for (const std::string& field : {tag, "\"other\", " + tag, tag.substr(2), std::string("*")}) {
    const Answer answer = get("/", "Connection: close\r\nIf-None-Match: " + field + "\r\n");
    EXPECT_EQ(answer.status, 304) << field;
    EXPECT_EQ(answer.body, "");
    EXPECT_EQ(answer.header("ETag"), tag);
    EXPECT_EQ(answer.header("Content-Length"), "");
  }
  EXPECT_EQ(get("/", "If-None-Match: \"other\"\r\n").status, 200);
}

TEST_F(web_page, only_files_whose_names_change_with_them_are_kept_without_asking) {
  EXPECT_EQ(get("/").header("Cache-Control"), "no-cache");
  EXPECT_NE(get("/assets/app-0123.js").header("Cache-Control").find("immutable"), std::string::npos);
}

TEST_F(web_page, the_page_may_load_nothing_from_elsewhere_and_nothing_inline) {
  for (const char* path : {"/", "/assets/app-0123.js"}) {
    const std::string policy = get(path).header("Content-Security-Policy");
    for (const char* part : {"default-src 'none'", "script-src 'self'", "style-src 'self'", "worker-src 'self'",
                             "connect-src 'self'", "frame-ancestors 'none'", "base-uri 'none'"})
      EXPECT_NE(policy.find(part), std::string::npos) << part;
    for (const char* part : {"unsafe", "*", "http"}) EXPECT_EQ(policy.find(part), std::string::npos) << part;
    EXPECT_EQ(get(path).header("X-Content-Type-Options"), "nosniff");
  }
}

TEST_F(web_page, the_files_compiled_in_begin_with_the_page_and_have_paths_of_their_own) {
  const std::vector<WebFile> files = web_files();
  ASSERT_FALSE(files.empty());
  EXPECT_EQ(files.front().path, "/");
  EXPECT_FALSE(files.front().is_fixed);
  std::set<std::string_view> paths;
  for (const WebFile& file : files) EXPECT_TRUE(paths.insert(file.path).second) << file.path;
  server_->stop();
  serve(files);
  for (const WebFile& file : files) {
    const Answer answer = get(std::string(file.path));
    EXPECT_EQ(answer.status, 200);
    EXPECT_EQ(answer.body, file.is_packed ? unpacked(std::string(file.bytes)) : file.bytes) << file.path;
  }
}

}  // namespace
}  // namespace remesh::server
