#include "server/work/memory_budget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "api/machine_limits.h"
#include "server/work/memory_watch.h"
#include "tests/server/stub_service.h"

namespace remesh::server {
namespace {

constexpr std::uint64_t kFactor = MemoryBudget::kWorkPerBodyByte;

int status_of(MemoryShare& share, std::uint64_t held, std::uint64_t expected) {
  try {
    share.hold_body(held, expected);
    return 200;
  } catch (const HttpError& error) {
    return error.problem.status;
  }
}

TEST(memory_budget, what_can_never_fit_differs_from_what_does_not_fit_now) {
  MemoryBudget budget(1000 * kFactor);
  const auto first = budget.open_share();
  EXPECT_EQ(status_of(*first, 0, 1000 * kFactor + 1), 413);
  EXPECT_EQ(status_of(*first, 600, 600), 200);
  EXPECT_EQ(budget.reserved(), 600 * kFactor);
  const auto second = budget.open_share();
  EXPECT_EQ(status_of(*second, 0, 500), 503);
  EXPECT_EQ(status_of(*second, 400, 400), 200);
  EXPECT_EQ(status_of(*first, 601, 601), 503);
  EXPECT_EQ(budget.reserved(), 1000 * kFactor);
}

TEST(memory_budget, a_body_whose_estimate_is_more_than_the_budget_leaves_room_for_small_ones_only) {
  MemoryBudget budget(1000 * kFactor);
  auto large = budget.open_share();
  EXPECT_EQ(status_of(*large, 1001, 1001), 200) << "the work may take less than is estimated";
  EXPECT_EQ(budget.reserved(), budget.usual_limit());
  const auto small = budget.open_share(), other = budget.open_share();
  EXPECT_EQ(status_of(*small, 1, 1), 200);
  EXPECT_EQ(status_of(*other, 0, 1001), 503);
  EXPECT_EQ(status_of(*other, 125, 125), 503) << "an eighth is left, and a part of that is taken";
  large.reset();
  EXPECT_EQ(status_of(*other, 0, 1001), 200);
}

TEST(memory_budget, work_that_was_ended_with_the_usual_limit_reserved_gets_all_next) {
  const MemoryBudget budget(800);
  EXPECT_EQ(budget.next_reservation(/*wanted=*/500, /*reserved=*/100), 500u);
  EXPECT_EQ(budget.next_reservation(900, 100), 700u);
  EXPECT_EQ(budget.next_reservation(900, 700), 800u);
}

TEST(memory_budget, an_estimate_is_reserved_as_a_whole_or_not_at_all) {
  MemoryBudget budget(1000);
  const auto other = budget.open_share(1);
  other->hold_body(600, 600);
  const auto share = budget.open_share(1);
  EXPECT_FALSE(share->try_hold(500));
  EXPECT_EQ(budget.reserved(), 600u);
  EXPECT_TRUE(share->try_hold(400));
  EXPECT_EQ(budget.reserved(), 1000u);
  EXPECT_TRUE(share->try_hold(100)) << "less than before";
  EXPECT_EQ(budget.reserved(), 700u);
  other->hold_answer(0);
  EXPECT_TRUE(share->try_hold(5000)) << "never more than all";
  EXPECT_EQ(budget.reserved(), 1000u);
}

TEST(memory_budget, an_announced_length_takes_nothing_until_it_comes) {
  MemoryBudget budget(1000 * kFactor);
  const auto slow = budget.open_share();
  EXPECT_EQ(status_of(*slow, 0, 1000), 200);
  EXPECT_EQ(status_of(*slow, 10, 1000), 200);
  EXPECT_EQ(budget.reserved(), 10 * kFactor);
}

TEST(memory_budget, all_is_given_back) {
  MemoryBudget budget(1000 * kFactor);
  {
    const auto share = budget.open_share();
    share->hold_body(500, 500);
    share->hold_answer(7);
    EXPECT_EQ(budget.reserved(), 7u);
  }
  EXPECT_EQ(budget.reserved(), 0u);
}

TEST(memory_budget, what_is_really_in_use_counts_where_it_is_more) {
  MemoryBudget budget(1000 * kFactor);
  const auto other = budget.open_share();
  other->hold_body(1, 1);
  const auto share = budget.open_share();
  budget.note_used(900 * kFactor);
  EXPECT_EQ(status_of(*share, 101, 101), 503);
  budget.note_used(0);
  EXPECT_EQ(status_of(*share, 101, 101), 200);
}

TEST(memory_budget, an_idle_process_takes_whatever_it_does_not_refuse_for_ever) {
  MemoryBudget budget(1000 * kFactor);
  budget.note_used(900 * kFactor);
  EXPECT_EQ(budget.available(), 1000 * kFactor);
  const auto share = budget.open_share();
  EXPECT_EQ(status_of(*share, 0, 1000), 200);
  EXPECT_EQ(status_of(*share, 500, 1000), 200);
  EXPECT_EQ(status_of(*share, 1000, 1000), 200);
  EXPECT_EQ(budget.available(), 100 * kFactor) << "what is used";
  EXPECT_EQ(status_of(*budget.open_share(), 101, 101), 503);
}

TEST(memory_watch, beyond_the_budget_the_request_that_grew_most_is_ended) {
  log::set_up(log::Format::kText, log::Level::kError);
  MemoryBudget budget(1000);
  RequestRegistry registry;
  MemoryWatch watch(budget, registry, std::chrono::hours(1));
  const auto old = registry.add("");
  const auto huge = registry.add("");
  old->is_computing = true;
  watch.look(100);
  huge->is_computing = true;
  watch.look(300);
  old->is_computing = false;
  watch.look(900);
  old->is_computing = true;
  EXPECT_FALSE(huge->control.is_stopped());
  watch.look(1001);
  EXPECT_EQ(huge->eviction, RunningRequest::Eviction::kAmongOthers);
  EXPECT_TRUE(huge->control.is_stopped());
  EXPECT_FALSE(old->control.is_stopped());
  watch.look(1100);
  EXPECT_FALSE(old->control.is_stopped()) << "the first one's memory may still be on its way back";
}

TEST(memory_watch, a_request_is_alone_only_where_nobody_else_holds_memory) {
  log::set_up(log::Format::kText, log::Level::kError);
  MemoryBudget budget(1000);
  RequestRegistry registry;
  MemoryWatch watch(budget, registry, std::chrono::hours(1));
  const auto own = budget.open_share(1);
  own->hold_body(1, 1);
  auto other = budget.open_share(1);
  other->hold_body(700, 700);
  EXPECT_EQ(budget.holders(), 2u);
  {
    const auto request = registry.add("");
    request->is_computing = true;
    watch.look(1001);
    EXPECT_EQ(request->eviction, RunningRequest::Eviction::kAmongOthers) << "an answer, say, that is being sent";
  }
  other.reset();
  EXPECT_EQ(budget.holders(), 1u);
  MemoryWatch next(budget, registry, std::chrono::hours(1));
  const auto request = registry.add("");
  request->is_computing = true;
  next.look(1001);
  EXPECT_EQ(request->eviction, RunningRequest::Eviction::kAlone);
}

using memory = StubService;

TEST_F(memory, a_body_that_cannot_fit_is_refused_before_it_is_sent) {
  config_.memory_budget = 160;  // less than the process: every body is too much now, or for ever
  start();
  RawClient client(port_);
  client.send("POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 500\r\nExpect: 100-continue\r\n\r\n");
  const Answer answer = client.answer();
  EXPECT_EQ(answer.status, 413);
  EXPECT_EQ(code_of(answer), "mesh_too_large");
  const std::string chunked = "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nTransfer-Encoding: chunked\r\n\r\n";
  EXPECT_EQ(ask(port_, chunked + "1f4\r\n" + std::string(500, 'x') + "\r\n0\r\n\r\n").status, 413);
}

TEST_F(memory, work_that_takes_too_much_is_ended_and_told_why) {
  config_.memory_budget = api::resident_memory() + (256 << 20);
  start();
  const auto client = start_blocking();
  const std::string much(512 << 20, 'x');  // as if the request took it
  const Answer answer = client->answer();
  EXPECT_EQ(answer.status, 413);  // it was alone: coming again would not help
  EXPECT_EQ(code_of(answer), "mesh_too_large");
}

TEST_F(memory, work_that_is_stopped_among_others_is_tried_again_within_its_time) {
  config_.max_running = 2;
  config_.memory_budget = api::resident_memory() + (400 << 20);
  start();
  auto other = start_blocking();
  RawClient client(port_);
  client.send(post_text("/v1/remesh", "hungry"));
  EXPECT_TRUE(eventually([&] { return stub_.stopped == 1; }));
  EXPECT_EQ(stub_.hungry, 1);
  other.reset();  // now there is room for what it was seen to take
  EXPECT_EQ(client.answer().status, 200);
  EXPECT_EQ(stub_.hungry, 2);
}

TEST(memory_watch, of_those_that_grew_about_as_much_the_last_one_is_ended) {
  log::set_up(log::Format::kText, log::Level::kError);
  MemoryBudget budget(1000);
  RequestRegistry registry;
  MemoryWatch watch(budget, registry, std::chrono::hours(1));
  const auto first = registry.add(""), second = registry.add(""), third = registry.add("");
  first->is_computing = second->is_computing = third->is_computing = true;
  third->growth = 400;
  first->growth = 810;
  second->growth = 800;
  watch.look(1200);
  EXPECT_EQ(second->eviction, RunningRequest::Eviction::kAmongOthers);
  EXPECT_EQ(first->eviction, RunningRequest::Eviction::kNone);
  EXPECT_EQ(third->eviction, RunningRequest::Eviction::kNone);
}

TEST(memory_watch, free_memory_of_the_allocator_is_returned_before_anybody_is_ended) {
  log::set_up(log::Format::kText, log::Level::kError);
  constexpr std::size_t kBlock = 64 << 10;
  constexpr std::size_t kBlocks = 6000;
  const auto use_and_free = [] {
    std::vector<std::unique_ptr<char[]>> blocks;
    for (std::size_t i = 0; i < kBlocks; ++i) {
      blocks.push_back(std::make_unique<char[]>(kBlock));
      std::fill_n(blocks.back().get(), kBlock, 'x');
    }
    // The last blocks stay, so that the allocator cannot return the others by itself.
    blocks.erase(blocks.begin(), blocks.end() - 10);
    return blocks;
  };
  const std::uint64_t before = api::resident_memory();
  const auto last = use_and_free();
  ASSERT_GT(api::resident_memory(), before + kBlock * kBlocks / 2) << "the allocator keeps free memory";
  MemoryBudget budget(before + kBlock * kBlocks / 2);
  RequestRegistry registry;
  const auto request = registry.add("");
  request->is_computing = true;
  const MemoryWatch watch(budget, registry, milliseconds(5));
  EXPECT_TRUE(eventually([&] { return api::resident_memory() < budget.limit(); }));
  EXPECT_EQ(request->eviction, RunningRequest::Eviction::kNone);
}

}  // namespace
}  // namespace remesh::server
