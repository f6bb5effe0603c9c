#include "server/work/request_registry.h"

#include <gtest/gtest.h>

#include <set>

namespace remesh::server {
namespace {

TEST(request_registry, a_request_is_found_while_it_runs_and_no_longer) {
  RequestRegistry registry;
  std::shared_ptr<RunningRequest> seen;
  {
    const auto entry = registry.add("abcdefgh-12345678");
    seen = registry.find("abcdefgh-12345678");
    ASSERT_NE(seen, nullptr);
    EXPECT_FALSE(seen->has_ended);
  }
  EXPECT_TRUE(seen->has_ended);
  EXPECT_EQ(registry.find("abcdefgh-12345678"), nullptr);
}

TEST(request_registry, an_id_in_use_is_replaced) {
  RequestRegistry registry;
  const auto first = registry.add("abcdefgh-12345678");
  {
    const auto second = registry.add("abcdefgh-12345678");
    EXPECT_NE(second->id, first->id);
    EXPECT_TRUE(is_request_id(second->id));
  }
  EXPECT_EQ(registry.find("abcdefgh-12345678"), first.get());
}

TEST(request_registry, a_request_is_found_by_its_owner_alone) {
  RequestRegistry registry;
  const auto entry = registry.add("abcdefgh-12345678", "one");
  EXPECT_EQ(registry.find("abcdefgh-12345678", "one"), entry.get());
  EXPECT_EQ(registry.find("abcdefgh-12345678", "another"), nullptr);
  EXPECT_EQ(registry.find("abcdefgh-12345678"), nullptr);
}

TEST(request_registry, an_id_in_use_by_another_owner_is_like_a_free_one) {
  RequestRegistry registry;
  const auto theirs = registry.add("abcdefgh-12345678", "one");
  {
    const auto mine = registry.add("abcdefgh-12345678", "another");
    EXPECT_EQ(mine->id, "abcdefgh-12345678");
    EXPECT_EQ(registry.find("abcdefgh-12345678", "another"), mine.get());
  }
  EXPECT_EQ(registry.find("abcdefgh-12345678", "another"), nullptr);
  EXPECT_EQ(registry.find("abcdefgh-12345678", "one"), theirs.get());
}

TEST(request_registry, cancelling_reaches_the_work_and_wakes_who_waits_for_it) {
  RequestRegistry registry;
  const auto entry = registry.add(new_request_id());
  EXPECT_FALSE(entry->changed.wait(Clock::now()));
  registry.cancel_all();
  EXPECT_TRUE(entry->control.is_stopped());
  EXPECT_TRUE(entry->changed.wait(Clock::now()));
}

TEST(request_registry, progress_tells_stage_and_fraction) {
  RequestRegistry registry;
  const auto entry = registry.add("abcdefgh-12345678");
  entry->control.enter(Stage::kTriangulation);
  entry->control.progress(0.25);
  EXPECT_EQ(progress_json(*entry.get())
                .rfind(R"({"id":"abcdefgh-12345678","stage":"triangulation","fraction":0.1275,"elapsed_s":)", 0),
            0u)
      << progress_json(*entry.get());
}

TEST(request_id, only_url_safe_ids_of_16_to_64_characters_are_taken) {
  EXPECT_TRUE(is_request_id("abcdefgh12345678"));
  EXPECT_TRUE(is_request_id(std::string(64, 'a')));
  EXPECT_TRUE(is_request_id("ABC-def_0123.~xx"));
  for (const std::string& text : {std::string(15, 'a'), std::string(65, 'a'), std::string("abcdefgh/12345678"),
                                  std::string("abcdefgh 12345678"), std::string("abcdefgh\"12345678"), std::string()}) {
    EXPECT_FALSE(is_request_id(text)) << text;
  }
}

TEST(request_id, new_ids_are_valid_and_differ) {
  std::set<std::string> seen;
  for (int i = 0; i < 1000; ++i) {
    const std::string id = new_request_id();
    EXPECT_TRUE(is_request_id(id));
    EXPECT_TRUE(seen.insert(id).second);
  }
}

}  // namespace
}  // namespace remesh::server
