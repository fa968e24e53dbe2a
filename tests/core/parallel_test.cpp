#include "snell/core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace snell {
namespace {

// Leaves the machine's own number of threads behind.
class Parallel : public ::testing::Test
{
  protected:
    void TearDown() override { set_thread_count(0); }
};

TEST_F(Parallel, EveryIndexOnce)
{
    for (const int threads : {0, 1, 2, 5}) {
        set_thread_count(threads);
        for (const std::size_t count : {0u, 1u, 2u, 1000u}) {
            std::vector<int> visits(count, 0); // plain: two threads at one index would be a race
            parallel_for(count, [&](std::size_t i) { visits[i] += 1; });
            EXPECT_EQ(visits, std::vector<int>(count, 1)) << threads << " threads";
        }
    }
}

TEST_F(Parallel, RangesCoverAll)
{
    std::vector<int> visits(10000, 0);
    std::atomic<bool> short_range = false;
    parallel_ranges(visits.size(), 100, [&](std::size_t begin, std::size_t end) {
        if (begin >= end) short_range = true;
        for (std::size_t i = begin; i < end; ++i) visits[i] += 1;
    });
    EXPECT_EQ(visits, std::vector<int>(10000, 1));
    EXPECT_FALSE(short_range);
}

TEST_F(Parallel, WhatThreadsWroteIsThereAfterwards)
{
    std::vector<double> values(4096, 0.0);
    for (int round = 0; round < 20; ++round) {
        parallel_for(values.size(), [&](std::size_t i) { values[i] += 1.0; });
        double sum = 0.0;
        for (const double value : values) sum += value;
        EXPECT_EQ(sum, 4096.0 * (round + 1));
    }
}

TEST_F(Parallel, Nested)
{
    std::vector<int> visits(64 * 64, 0);
    parallel_for(64, [&](std::size_t i) { parallel_for(64, [&](std::size_t j) { visits[i * 64 + j] += 1; }); });
    EXPECT_EQ(visits, std::vector<int>(64 * 64, 1));
}

static int sum_of_halves(const std::vector<int>& values, std::size_t begin, std::size_t end)
{
    if (end - begin == 1) return values[begin];
    int left = 0, right = 0;
    const std::size_t middle = begin + (end - begin) / 2;
    parallel_both([&] { left = sum_of_halves(values, begin, middle); },
                  [&] { right = sum_of_halves(values, middle, end); });
    return left + right;
}

TEST_F(Parallel, BothRecursively)
{
    EXPECT_EQ(sum_of_halves(std::vector<int>(3000, 2), 0, 3000), 6000);
    EXPECT_THROW(parallel_both([] {}, [] { throw std::runtime_error("here"); }), std::runtime_error);
}

TEST_F(Parallel, ExceptionsComeOut)
{
    EXPECT_THROW(parallel_for(1000,
                              [](std::size_t i) {
                                  if (i == 500) throw std::runtime_error("here");
                              }),
                 std::runtime_error);
    EXPECT_THROW(parallel_ranges(1000, 10, [](std::size_t, std::size_t) { throw std::runtime_error("here"); }),
                 std::runtime_error);
}

TEST_F(Parallel, ThreadCount)
{
    set_thread_count(3);
    EXPECT_EQ(thread_count(), 3);
    set_thread_count(0);
    EXPECT_GE(thread_count(), 1);
}

TEST_F(Parallel, WhatIsCancelledStops)
{
    for (const int threads : {1, 4}) {
        set_thread_count(threads);
        std::atomic<bool> cancel = false;
        std::atomic<int> calls = 0;
        const auto work = [&] {
            parallel_for(1000, [&](std::size_t) {
                parallel_both([&] { ++calls; },
                              [&] { parallel_ranges(10, 1, [&](std::size_t, std::size_t) { ++calls; }); });
                if (calls > 100) cancel = true;
            });
        };
        {
            const CancelScope scope(cancel);
            EXPECT_THROW(work(), Cancelled);
        }
        EXPECT_GT(calls, 100);
        EXPECT_LT(calls, 5000);
        // outside, nobody asks
        calls = 0;
        work();
        EXPECT_EQ(calls, 11000);
        // and another's cancelling is not mine
        std::atomic<bool> mine = false;
        const CancelScope scope(mine);
        calls = 0;
        work();
        EXPECT_EQ(calls, 11000);
    }
}

// An inner call must not return with half of its work done because something beside it has thrown.
TEST_F(Parallel, AnInnerCallReturnsCompleteOrNotAtAll)
{
    for (int attempt = 0; attempt < 50; ++attempt) {
        std::atomic<bool> half_done = false;
        const auto inner = [&] {
            std::vector<int> visits(500, 0);
            parallel_for(visits.size(), [&](std::size_t i) { visits[i] = 1; });
            for (const int visit : visits)
                if (visit == 0) half_done = true;
        };
        EXPECT_THROW(parallel_for(64,
                                  [&](std::size_t i) {
                                      if (i == 40) throw std::runtime_error("one of them");
                                      inner();
                                  }),
                     std::runtime_error);
        EXPECT_FALSE(half_done);
    }
}

} // namespace
} // namespace snell
