#include "server/http/read_ahead.h"

#include <gtest/gtest.h>

#include <optional>
#include <vector>

namespace remesh::server {
namespace {

TEST(read_ahead, has_a_limit_for_each_connection_and_one_for_all) {
  ReadAhead all;
  std::vector<std::optional<ReadAhead::Share>> shares(5);
  for (std::optional<ReadAhead::Share>& share : shares) share.emplace(&all);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(shares[i]->take(1000), 1000u);
    EXPECT_EQ(shares[i]->take(2 * ReadAhead::kMaxOfOne), ReadAhead::kMaxOfOne - 1000);
    EXPECT_EQ(shares[i]->take(1), 0u);
  }
  EXPECT_EQ(shares[4]->take(1), 0u) << "all have taken the limit together";
  shares[0]->give_back(10);
  EXPECT_EQ(shares[4]->take(100), 10u);
  shares[1].reset();
  EXPECT_EQ(shares[4]->take(100), 100u) << "what is left is given back";
}

TEST(read_ahead, takes_nothing_without_a_limit_to_keep) {
  ReadAhead::Share share(nullptr);
  EXPECT_EQ(share.take(1), 0u);
}

}  // namespace
}  // namespace remesh::server
