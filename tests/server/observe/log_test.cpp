#include "server/observe/log.h"

#include <gtest/gtest.h>

namespace remesh::server::log {
namespace {

TEST(log, values_stand_by_their_names) {
  EXPECT_EQ(render(Format::kText, "request", {{"path", "/a"}, {"status", std::int64_t{200}}, {"ms", 1.5}}),
            "request path=/a status=200 ms=1.500");
  EXPECT_EQ(render(Format::kJson, "request", {{"path", "/a"}, {"status", std::int64_t{200}}}),
            R"("event":"request","path":"/a","status":200)");
}

TEST(log, what_clients_send_cannot_forge_a_line) {
  const std::string evil = "a\r\n\"level\":\"x\" \x1b[2J\xff\\";
  for (const Format format : {Format::kText, Format::kJson}) {
    const std::string line = render(format, "request", {{"path", evil}});
    for (const char c : line) EXPECT_TRUE(c >= 0x20 && c < 0x7f);
    EXPECT_NE(line.find(R"("a\u000d\u000a\"level\":\"x\" \u001b[2J\u00ff\\")"), std::string::npos) << line;
  }
}

}  // namespace
}  // namespace remesh::server::log
