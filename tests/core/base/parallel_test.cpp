#include "core/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <mutex>
#include <set>
#include <stdexcept>
#include <vector>

namespace hairbake {
namespace {

using Pieces = std::multiset<std::pair<std::size_t, std::size_t>>;

Pieces pieces_of(std::size_t count, std::size_t grain) {
    std::mutex mutex;
    Pieces pieces;
    parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
        const std::lock_guard lock(mutex);
        pieces.insert({begin, end});
    });
    return pieces;
}

TEST(Parallel, CutsTheSamePiecesForAnyNumberOfThreads) {
    const Pieces expected{{0, 4}, {4, 8}, {8, 10}};
    for (const int threads : {1, 2, 7}) with_threads(threads, [&] { EXPECT_EQ(pieces_of(10, 4), expected); });
    EXPECT_EQ(pieces_of(10, 4), expected);
}

TEST(Parallel, CoversEveryItemOnce) {
    for (const std::size_t count : {1u, 2u, 99u, 100u, 101u, 10'000u})
        for (const std::size_t grain : {1u, 3u, 100u, 20'000u}) {
            std::vector<std::atomic<int>> visits(count);
            parallel_for(count, grain, [&](std::size_t begin, std::size_t end) {
                EXPECT_LT(begin, end);
                EXPECT_LE(end - begin, grain);
                for (std::size_t i = begin; i < end; ++i) ++visits[i];
            });
            for (const auto& visit : visits) ASSERT_EQ(visit, 1);
        }
}

TEST(Parallel, DoesNothingOverNothingAndTakesAGrainOfZeroAsOne) {
    EXPECT_TRUE(pieces_of(0, 4).empty());
    EXPECT_EQ(pieces_of(3, 0), (Pieces{{0, 1}, {1, 2}, {2, 3}}));
}

TEST(Parallel, RethrowsAnException) {
    for (const int threads : {1, 2, 7})
        with_threads(threads, [] {
            const auto body = [](std::size_t begin, std::size_t) {
                if (begin == 50) throw std::runtime_error("piece 50");
            };
            try {
                parallel_for(100, 1, body);
                ADD_FAILURE() << "the exception was lost";
            } catch (const std::runtime_error& error) {
                EXPECT_STREQ(error.what(), "piece 50");
            }
        });
    EXPECT_THROW(with_threads(2, [] { throw std::logic_error("outside of parallel_for"); }), std::logic_error);
}

TEST(Parallel, UsesTheThreadsAskedFor) {
    for (const int threads : {1, 2, 7})
        with_threads(threads, [&] {
            EXPECT_EQ(thread_count(), threads);
            parallel_for(1000, 1, [&](std::size_t, std::size_t) {
                EXPECT_GE(thread_index(), 0);
                EXPECT_LT(thread_index(), threads);
            });
        });
    with_threads(0, [] { EXPECT_GE(thread_count(), 1); });
}

TEST(Parallel, NestsWithoutLosingWork) {
    std::atomic<int> sum = 0;
    parallel_for(20, 1, [&](std::size_t, std::size_t) {
        parallel_for(30, 7, [&](std::size_t begin, std::size_t end) { sum += static_cast<int>(end - begin); });
    });
    EXPECT_EQ(sum, 600);
}

}  // namespace
}  // namespace hairbake
