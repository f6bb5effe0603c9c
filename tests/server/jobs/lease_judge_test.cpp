/// Tests when a worker counts as dead. All times are given, so nothing waits here.
#include "server/jobs/lease_judge.h"

#include <gtest/gtest.h>

#include <vector>

namespace remesh::server::jobs {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class lease_judge : public ::testing::Test {
 protected:
  /// Lets time pass in steps of a second, in which the store answers at once.
  void pass(seconds time) {
    for (seconds i{0}; i < time; ++i) {
      now_ += seconds(1);
      judge_.record_reached(now_, now_);
    }
  }
  /// Lets time pass in which the store does not answer.
  void outage(seconds time) {
    now_ += time;
    judge_.record_failed();
  }
  std::vector<LeaseJudge::Sign> judge(std::int64_t version = 1, std::int64_t token = 1) {
    return judge_.judge({{"job", token, version, milliseconds(5000)}});
  }

  LeaseJudge judge_{seconds(2)};
  Clock::time_point now_ = Clock::now();
};

TEST_F(lease_judge, a_job_whose_row_stays_the_same_for_a_lease_has_lost_its_worker) {
  pass(seconds(1));
  EXPECT_TRUE(judge().empty());
  pass(seconds(4));
  EXPECT_TRUE(judge().empty());
  pass(seconds(1));
  ASSERT_EQ(judge().size(), 1u);
  EXPECT_EQ(judge()[0].id, "job");
}

TEST_F(lease_judge, a_lease_counts_from_when_this_judge_first_saw_the_job) {
  pass(seconds(3600));
  EXPECT_TRUE(judge().empty());
  pass(seconds(4));
  EXPECT_TRUE(judge().empty());
}

TEST_F(lease_judge, a_changed_row_is_a_sign_of_life) {
  pass(seconds(1));
  for (int version = 1; version < 20; ++version) {
    EXPECT_TRUE(judge(version).empty());
    pass(seconds(4));
  }
  EXPECT_TRUE(judge(20, 1).empty());
  pass(seconds(4));
  EXPECT_TRUE(judge(20, 2).empty()) << "another claim";
  pass(seconds(4));
  EXPECT_TRUE(judge(20, 2).empty());
}

TEST_F(lease_judge, an_outage_does_not_age_a_lease) {
  pass(seconds(1));
  EXPECT_TRUE(judge().empty());
  outage(seconds(3600));
  pass(seconds(1));  // the first answer only says that the store is back
  EXPECT_TRUE(judge().empty());
  pass(seconds(4));
  EXPECT_TRUE(judge().empty());
  pass(seconds(1));
  EXPECT_EQ(judge().size(), 1u) << "one lease after the store is back";
}

TEST_F(lease_judge, a_store_that_flaps_ages_a_lease_only_while_it_answers) {
  pass(seconds(1));
  EXPECT_TRUE(judge().empty());
  for (int i = 0; i < 100; ++i) {
    outage(seconds(8));
    pass(seconds(1));
    EXPECT_TRUE(judge().empty());
  }
}

TEST_F(lease_judge, the_time_of_a_call_that_waited_does_not_count) {
  pass(seconds(1));
  EXPECT_TRUE(judge().empty());
  // A lock on the table held up these calls, and all renewals with them. A single one would count as a pause, which
  // is shorter than the lease.
  for (int i = 0; i < 10; ++i) {
    judge_.record_reached(now_, now_ + seconds(60));
    now_ += seconds(60);
    EXPECT_TRUE(judge().empty()) << i;
  }
}

TEST_F(lease_judge, a_judge_that_was_stopped_itself_does_not_count_that_time) {
  pass(seconds(1));
  EXPECT_TRUE(judge().empty());
  now_ += seconds(3600);
  pass(seconds(1));
  EXPECT_TRUE(judge().empty());
}

TEST_F(lease_judge, a_job_that_was_away_is_judged_anew) {
  pass(seconds(1));
  EXPECT_TRUE(judge().empty());
  EXPECT_TRUE(judge_.judge({}).empty());
  pass(seconds(4));
  EXPECT_TRUE(judge().empty());
  pass(seconds(4));
  EXPECT_TRUE(judge().empty());
}

}  // namespace
}  // namespace remesh::server::jobs
