#include "server/work/memory_budget.h"

#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "api/machine_limits.h"
#include "server/work/memory_wait.h"
#include "server/work/memory_watch.h"
#include "tests/server/stub_daemon.h"

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

// ---- the line of those who find no memory. All times are given, so nothing waits here.

using std::chrono::seconds;

class memory_line : public ::testing::Test {
 protected:
  std::shared_ptr<MemoryShare> holder(std::uint64_t bytes) {
    auto share = budget_.open_share(1);
    EXPECT_TRUE(share->try_hold(bytes, now_));
    return share;
  }
  /// Tries to reserve as `wait_for_memory` does.
  bool tries(const std::shared_ptr<MemoryShare>& share, std::uint64_t bytes) {
    if (share->try_hold(bytes, now_)) return true;
    share->stand_in_line(now_);
    return false;
  }
  bool newcomer_passes(std::uint64_t bytes) { return budget_.open_share(1)->try_hold(bytes, now_); }

  MemoryBudget budget_{1000};
  Clock::time_point now_ = Clock::now();
};

TEST_F(memory_line, small_ones_pass_a_large_one_until_it_has_lost_its_patience) {
  const auto large = budget_.open_share(1);
  // Small ones overlap, so that there is always one.
  auto small = holder(100);
  bool has_begun = false;
  for (int i = 0; i < 100 && !has_begun; ++i) {
    now_ += milliseconds(100);
    has_begun = tries(large, 1000);
    if (has_begun) break;
    const bool is_patient = i < 51;
    EXPECT_EQ(newcomer_passes(1), is_patient) << i;
    if (is_patient) small = holder(100);
    if (!is_patient) small.reset();
  }
  EXPECT_TRUE(has_begun);
  EXPECT_EQ(budget_.waiting(), 0u);
  EXPECT_FALSE(newcomer_passes(1)) << "all is taken";
  large->hold_answer(0);
  EXPECT_TRUE(newcomer_passes(1000));
}

TEST_F(memory_line, newcomers_pass_while_what_ran_before_leaves_no_room_for_the_first_in_any_case) {
  auto before = holder(500);
  const auto large = budget_.open_share(1);
  EXPECT_FALSE(tries(large, 800));
  now_ += seconds(60);
  EXPECT_TRUE(newcomer_passes(1));
  const auto young = holder(300);
  EXPECT_FALSE(tries(large, 800));
  before.reset();
  EXPECT_FALSE(newcomer_passes(1)) << "now it waits for those alone who passed it";
  EXPECT_EQ(budget_.available(now_), 0u);
  young->hold_answer(200);
  EXPECT_TRUE(tries(large, 800));
  EXPECT_EQ(budget_.available(now_), 0u);
}

TEST_F(memory_line, memory_that_is_really_in_use_by_what_ran_before_counts_for_it) {
  auto before = holder(1);
  budget_.record_used(600);
  const auto large = budget_.open_share(1);
  EXPECT_FALSE(tries(large, 800));
  now_ += seconds(60);
  EXPECT_TRUE(newcomer_passes(1));
  const auto young = holder(1);
  before.reset();
  EXPECT_FALSE(newcomer_passes(1));
}

TEST_F(memory_line, all_who_wait_begin_at_once_if_there_is_room_for_all) {
  auto all = holder(1000);
  std::vector<std::shared_ptr<MemoryShare>> line;
  for (int i = 0; i < 100; ++i) {
    line.push_back(budget_.open_share(1));
    EXPECT_FALSE(tries(line.back(), 10));
  }
  now_ += seconds(60);
  all.reset();
  EXPECT_EQ(budget_.available(now_), 990u) << "the first one's room is its own";
  EXPECT_FALSE(newcomer_passes(991));
  // The first one looks last.
  for (auto share = line.rbegin(); share != line.rend(); ++share) EXPECT_TRUE(tries(*share, 10));
  EXPECT_EQ(budget_.waiting(), 0u);
  EXPECT_EQ(budget_.reserved(), 1000u);
}

TEST_F(memory_line, who_holds_memory_may_have_more_although_another_waits_for_all) {
  const auto growing = holder(100);
  const auto large = budget_.open_share(1);
  EXPECT_FALSE(tries(large, 1000));
  now_ += seconds(60);
  EXPECT_TRUE(growing->try_hold(300, now_));
  growing->hold_answer(0);
  EXPECT_FALSE(growing->try_hold(300, now_)) << "it holds nothing, and comes anew";
  EXPECT_TRUE(tries(large, 1000));
}

TEST_F(memory_line, the_first_does_not_hold_up_others_for_ever) {
  const auto large = budget_.open_share(1);
  const auto old = holder(1);
  EXPECT_FALSE(tries(large, 1000));
  now_ += MemoryBudget::kPatience;
  EXPECT_TRUE(newcomer_passes(1)) << "the old one is in the way";
  const auto small = holder(1);
  old->hold_answer(0);
  int held_up = 0, passed = 0;
  for (int i = 0; i < 60; ++i, now_ += seconds(1)) ++(newcomer_passes(1) ? passed : held_up);
  EXPECT_GE(held_up, 19);
  EXPECT_GE(passed, 5) << "the one that passed is taken for an old one after a while";
}

TEST_F(memory_line, those_who_wait_longest_come_first) {
  auto all = holder(1000);
  const auto first = budget_.open_share(1), second = budget_.open_share(1), before = budget_.open_share(1);
  EXPECT_FALSE(tries(first, 600));
  now_ += seconds(1);
  EXPECT_FALSE(tries(second, 600));
  now_ += seconds(10);
  all.reset();
  EXPECT_FALSE(tries(second, 600));
  EXPECT_TRUE(tries(first, 600));
  EXPECT_FALSE(tries(second, 600));
  // One that has waited elsewhere takes its place by its time.
  before->stand_in_line(now_ - seconds(100));
  EXPECT_FALSE(before->try_hold(1000, now_));
  first->hold_answer(0);
  EXPECT_FALSE(tries(second, 600));
  EXPECT_TRUE(before->try_hold(1000, now_));
}

TEST_F(memory_line, one_that_gives_up_or_ends_leaves_the_line) {
  const auto all = holder(1000);
  auto first = budget_.open_share(1);
  const auto second = budget_.open_share(1);
  EXPECT_FALSE(tries(first, 600));
  EXPECT_FALSE(tries(second, 600));
  EXPECT_EQ(budget_.waiting(), 2u);
  first.reset();
  second->leave_line();
  EXPECT_EQ(budget_.waiting(), 0u);
  now_ += seconds(60);
  all->hold_answer(0);
  EXPECT_TRUE(newcomer_passes(1000));
}

TEST_F(memory_line, if_all_who_hold_memory_wait_for_more_the_last_one_is_refused) {
  const auto first = holder(500), second = holder(400);
  const auto newcomer = budget_.open_share(1);
  EXPECT_FALSE(tries(newcomer, 200));
  EXPECT_FALSE(tries(first, 800));
  EXPECT_FALSE(first->is_stuck()) << "the other may end";
  EXPECT_FALSE(tries(second, 700));
  EXPECT_FALSE(first->is_stuck());
  EXPECT_FALSE(newcomer->is_stuck());
  EXPECT_TRUE(second->is_stuck());
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
  budget.record_used(900 * kFactor);
  EXPECT_EQ(status_of(*share, 101, 101), 503);
  budget.record_used(0);
  EXPECT_EQ(status_of(*share, 101, 101), 200);
}

TEST(memory_budget, an_idle_process_takes_whatever_it_does_not_refuse_for_ever) {
  MemoryBudget budget(1000 * kFactor);
  budget.record_used(900 * kFactor);
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

TEST(memory_watch, a_request_is_not_alone_with_what_is_stored_in_memory) {
  log::set_up(log::Format::kText, log::Level::kError);
  MemoryBudget budget(1000);
  budget.record_stored(600);
  RequestRegistry registry;
  const auto eviction_at = [&](std::uint64_t used) {
    MemoryWatch watch(budget, registry, std::chrono::hours(1));
    const auto request = registry.add("");
    request->is_computing = true;
    watch.look(used);
    return request->eviction.load();
  };
  EXPECT_EQ(eviction_at(1001), RunningRequest::Eviction::kAmongOthers);
  EXPECT_EQ(eviction_at(1600), RunningRequest::Eviction::kAmongOthers);
  EXPECT_EQ(eviction_at(1601), RunningRequest::Eviction::kAlone);
}

TEST(memory_wait, all_waiting_of_a_request_is_one_time) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
  Connection connection(ends[0]);
  const Connection client(ends[1]);
  MemoryBudget budget(1000);
  const auto other = budget.open_share(1), share = budget.open_share(1);
  ASSERT_TRUE(other->try_hold(1000));
  Request request;
  request.minor_version = 1;
  const auto waits = [&](milliseconds patience) {
    hold_body_in_line(*share, 1, 1, request, connection, {patience, patience});
  };
  EXPECT_THROW(waits(milliseconds(50)), HttpError);
  EXPECT_GE(request.waited, milliseconds(50));
  request.waited = std::chrono::hours(1);
  EXPECT_THROW(waits(std::chrono::hours(1)), HttpError) << "it has waited long enough";
  other->hold_answer(0);
  waits(std::chrono::hours(1));
  EXPECT_EQ(share->bytes(), 1u);
}

TEST(memory_wait, nothing_of_a_body_is_read_before_there_is_memory_for_it) {
  std::array<int, 2> ends{};
  ASSERT_EQ(::socketpair(AF_UNIX, SOCK_STREAM, 0, ends.data()), 0);
  ReadAhead ahead;
  Connection connection(ends[0], &ahead);
  const Connection client(ends[1]);
  ASSERT_EQ(::send(ends[1], "body", 4, 0), 4);
  MemoryBudget budget(1000);
  const auto other = budget.open_share(1), share = budget.open_share(1);
  ASSERT_TRUE(other->try_hold(1000));
  Request request;
  request.minor_version = 1;
  const auto wait = [&] {
    EXPECT_THROW(hold_body_in_line(*share, 4, 4, request, connection, {milliseconds(50), milliseconds(50)}), HttpError);
    request.waited = {};
    int left = 0;
    EXPECT_EQ(::ioctl(ends[0], FIONREAD, &left), 0);
    return left;
  };
  EXPECT_EQ(wait(), 4);
  request.timing.body = 1;  // now what comes is another request, behind which the end of the connection is seen
  EXPECT_EQ(wait(), 0);
}

TEST(memory_wait, no_more_than_so_many_wait) {
  MemoryBudget budget(1000, MemoryBudget::kPatience, /*max_waiting=*/2);
  const auto first = budget.open_share(1), second = budget.open_share(1), third = budget.open_share(1);
  EXPECT_TRUE(first->try_stand_in_line());
  EXPECT_TRUE(second->try_stand_in_line());
  EXPECT_FALSE(third->try_stand_in_line());
  third->stand_in_line(Clock::now());
  EXPECT_EQ(budget.waiting(), 3u) << "a job";
}

using memory = StubDaemon;

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

/// A client whose upload has reserved nearly all memory, and which sends no more.
std::unique_ptr<RawClient> take_memory(int port) {
  constexpr std::size_t kSent = 32 << 20;
  auto client = std::make_unique<RawClient>(port);
  client->send("POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: " + std::to_string(2 * kSent) +
               "\r\n\r\n");
  client->send(std::string(kSent, 'x'));
  return client;
}

constexpr const char* kLargeHead =
    "POST /v1/remesh HTTP/1.1\r\nHost: localhost\r\nContent-Length: 33000000\r\nExpect: 100-continue\r\n\r\n";

TEST_F(memory, a_request_that_finds_no_memory_waits_for_it) {
  config_.limits.max_body = 64 << 20;
  config_.memory_budget = api::resident_memory() + (64 << 20);
  start();
  auto taken = take_memory(port_);
  RawClient waiting(port_);
  waiting.send(kLargeHead);
  std::this_thread::sleep_for(milliseconds(200));
  EXPECT_FALSE(waiting.has_input());
  taken.reset();
  EXPECT_EQ(waiting.receive("\r\n\r\n"), "HTTP/1.1 100 Continue\r\n\r\n");
}

TEST_F(memory, requests_that_wait_for_memory_leave_connections_to_others) {
  config_.limits.max_body = 64 << 20;
  config_.memory_budget = api::resident_memory() + (64 << 20);
  config_.connections.max_connections = 8;
  start();
  const auto taken = take_memory(port_);
  std::vector<std::unique_ptr<RawClient>> waiting;
  for (int i = 0; i < 2; ++i) {
    waiting.push_back(std::make_unique<RawClient>(port_));
    waiting.back()->send(kLargeHead);
  }
  EXPECT_TRUE(
      eventually([&] { return get(port_, "/metrics").body.find("remeshd_memory_waiting 2") != std::string::npos; }));
  for (int i = 0; i < 8; ++i) {
    const Answer answer = ask(port_, kLargeHead);
    EXPECT_EQ(code_of(answer), "out_of_memory");
    EXPECT_NE(answer.header("Retry-After"), "");
  }
  EXPECT_EQ(get(port_, "/livez").status, 200);
}

TEST_F(memory, a_request_waits_for_memory_no_longer_than_its_time) {
  config_.limits.max_body = 64 << 20;
  config_.limits.request_timeout = milliseconds(300);
  config_.memory_budget = api::resident_memory() + (64 << 20);
  start();
  const auto taken = take_memory(port_);
  RawClient waiting(port_);
  waiting.send(kLargeHead);
  EXPECT_EQ(code_of(waiting.answer()), "out_of_memory");
}

TEST_F(memory, a_stop_ends_a_request_that_waits_for_memory) {
  config_.limits.max_body = 64 << 20;
  config_.memory_budget = api::resident_memory() + (64 << 20);
  start();
  const auto taken = take_memory(port_);
  RawClient waiting(port_);
  waiting.send(kLargeHead);
  std::this_thread::sleep_for(milliseconds(100));
  EXPECT_FALSE(waiting.has_input());
  daemon_->stop();
  EXPECT_EQ(code_of(waiting.answer()), "draining");
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

TEST(memory_watch, a_request_that_grows_fast_is_ended_before_it_is_over_the_budget) {
  log::set_up(log::Format::kText, log::Level::kError);
  MemoryBudget budget(1000);
  RequestRegistry registry;
  MemoryWatch watch(budget, registry, std::chrono::hours(1));
  const Clock::time_point start = Clock::now();
  const auto growth = [&](std::uint64_t used, int ms) { return watch.expected_growth(used, start + milliseconds(ms)); };
  EXPECT_EQ(growth(100, 0), 0u) << "nothing is known before";
  EXPECT_EQ(growth(800, 50), 0u) << "much is left";
  EXPECT_EQ(growth(900, 100), 800u);
  EXPECT_EQ(growth(910, 150), 110u);
  EXPECT_EQ(growth(905, 260), 0u);
  EXPECT_EQ(growth(880, 700), 0u);
  EXPECT_EQ(growth(909, 900), 0u) << "as much was in use before";
  EXPECT_EQ(growth(920, 1000), 10u);
  EXPECT_EQ(growth(960, 1400), 10u) << "a late look: 40 more in 400 ms";
  EXPECT_EQ(growth(980, 9000), 0u) << "nothing is known of the last second";
  const auto request = registry.add("");
  request->is_computing = true;
  watch.look(900, 1000);
  EXPECT_EQ(request->eviction, RunningRequest::Eviction::kNone);
  request->growth = 100;
  watch.look(900, 1001);
  EXPECT_EQ(request->eviction, RunningRequest::Eviction::kNone) << "what grows is something else";
  request->growth = 101;
  watch.look(900, 1001);
  EXPECT_EQ(request->eviction, RunningRequest::Eviction::kAlone);
}

TEST(memory_watch, a_request_that_was_ended_among_others_was_never_alone) {
  log::set_up(log::Format::kText, log::Level::kError);
  RunningRequest request("");
  request.evict(/*was_alone=*/false);
  request.evict(/*was_alone=*/true);
  EXPECT_EQ(request.eviction, RunningRequest::Eviction::kAmongOthers);
}

TEST(memory_watch, files_in_memory_count_as_used) {
  log::set_up(log::Format::kText, log::Level::kError);
  MemoryBudget budget(api::resident_memory() + (256 << 20));
  RequestRegistry registry;
  const auto request = registry.add("");
  request->is_computing = true;
  const MemoryWatch watch(budget, registry, milliseconds(5));
  std::this_thread::sleep_for(milliseconds(50));
  EXPECT_EQ(request->eviction, RunningRequest::Eviction::kNone);
  budget.record_stored(512 << 20);
  EXPECT_TRUE(eventually([&] { return request->eviction != RunningRequest::Eviction::kNone; }));
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
