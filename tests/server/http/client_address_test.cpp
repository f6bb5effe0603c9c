#include "server/http/client_address.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace remesh::server {
namespace {

RequestHead with(const Fields& fields) {
  RequestHead head;
  head.headers = fields;
  return head;
}

TEST(trusted_proxies, an_address_or_its_network_is_trusted) {
  const TrustedProxies proxies("127.0.0.1, 10.1.0.0/16,fd00::/8");
  for (const char* address : {"127.0.0.1", "::ffff:127.0.0.1", "10.1.255.3", "fd12::1"})
    EXPECT_TRUE(proxies.contains(address)) << address;
  for (const char* address : {"127.0.0.2", "10.2.0.1", "fe80::1", "::1", "", "localhost"})
    EXPECT_FALSE(proxies.contains(address)) << address;
  EXPECT_FALSE(TrustedProxies().contains("127.0.0.1"));
  EXPECT_TRUE(TrustedProxies("0.0.0.0/0").contains("1.2.3.4"));
  EXPECT_FALSE(TrustedProxies("0.0.0.0/0").contains("fd00::1"));
  for (const char* bad : {"localhost", "10.0.0.0/33", "10.0.0.0/", "10.0.0.0/-1", "10.0.0.0/8x", "::/129", "1.2.3"})
    EXPECT_THROW(TrustedProxies{bad}, std::invalid_argument) << bad;
}

TEST(client_address, only_a_trusted_proxy_names_the_client) {
  const RequestHead head = with({{"x-forwarded-for", "9.9.9.9"}, {"forwarded", "for=8.8.8.8"}});
  EXPECT_EQ(client_address(head, "10.0.0.1", TrustedProxies()), "10.0.0.1");
  EXPECT_EQ(client_address(head, "10.0.0.2", TrustedProxies("10.0.0.1")), "10.0.0.2");
  EXPECT_EQ(client_address(head, "10.0.0.1", TrustedProxies("10.0.0.1")), "9.9.9.9");
}

TEST(client_address, it_is_the_last_one_that_is_no_trusted_proxy) {
  const TrustedProxies proxies("10.0.0.0/8");
  const auto client = [&](const Fields& fields) { return client_address(with(fields), "10.0.0.1", proxies); };
  EXPECT_EQ(client({{"x-forwarded-for", "6.6.6.6, 9.9.9.9, 10.0.0.2"}}), "9.9.9.9");
  EXPECT_EQ(client({{"x-forwarded-for", "6.6.6.6"}, {"x-forwarded-for", "9.9.9.9"}}), "9.9.9.9");
  EXPECT_EQ(client({{"x-forwarded-for", "10.0.0.3, 10.0.0.2"}}), "10.0.0.3");
  EXPECT_EQ(client({{"x-forwarded-for", "9.9.9.9:4711"}}), "9.9.9.9");
  EXPECT_EQ(client({{"x-forwarded-for", "[2001:db8::1]:4711"}}), "2001:db8::1");
  EXPECT_EQ(client({{"x-forwarded-for", "2001:db8::1"}}), "2001:db8::1");
  EXPECT_EQ(client({{"forwarded", "for=6.6.6.6, for=\"[2001:db8::1]:80\";proto=https"}}), "2001:db8::1");
  EXPECT_EQ(client({{"forwarded", "proto=https;For=9.9.9.9"}}), "9.9.9.9");
}

TEST(client_address, what_is_no_address_ends_the_search) {
  const TrustedProxies proxies("10.0.0.0/8");
  const auto client = [&](const Fields& fields) { return client_address(with(fields), "10.0.0.1", proxies); };
  for (const char* hidden : {"unknown", "_secret", "", "9.9.9.9, x", "9.9.9.9, unknown"})
    EXPECT_EQ(client({{"x-forwarded-for", hidden}}), "10.0.0.1") << hidden;
  EXPECT_EQ(client({{"x-forwarded-for", "9.9.9.9, unknown, 10.0.0.2"}}), "10.0.0.2");
  EXPECT_EQ(client({{"forwarded", "for=unknown"}}), "10.0.0.1");
  EXPECT_EQ(client({{"forwarded", "by=9.9.9.9"}}), "10.0.0.1");
  EXPECT_EQ(client({}), "10.0.0.1");
}

TEST(client_address, a_client_that_a_proxy_does_not_name_is_hidden) {
  const TrustedProxies proxies("10.0.0.0/8");
  const auto is_hidden = [&](const Fields& fields) { return is_client_hidden(with(fields), "10.0.0.1", proxies); };
  for (const char* list : {"unknown", "9.9.9.9, unknown", "9.9.9.9, _x, 10.0.0.2"})
    EXPECT_TRUE(is_hidden({{"x-forwarded-for", list}})) << list;
  EXPECT_TRUE(is_hidden({{"forwarded", "for=unknown"}}));
  EXPECT_FALSE(is_hidden({{"x-forwarded-for", "unknown, 9.9.9.9"}}));
  EXPECT_FALSE(is_hidden({{"x-forwarded-for", "10.0.0.3, 10.0.0.2"}}));
  EXPECT_FALSE(is_hidden({}));
  EXPECT_FALSE(is_client_hidden(with({{"x-forwarded-for", "unknown"}}), "9.9.9.9", proxies));
}

}  // namespace
}  // namespace remesh::server
