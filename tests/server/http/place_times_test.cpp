#include "server/http/place_times.h"

#include <gtest/gtest.h>

#include <list>

namespace hairbake {
namespace {

using std::chrono::seconds;

TEST(PlaceTimes, TheWaitIsTheMeanRestOfTheBodiesUnderWay) {
    PlaceTimes times;
    const PlaceTimes::Clock::time_point begin = PlaceTimes::Clock::now();
    EXPECT_EQ(times.seconds_until_one_ends("a", begin), 1);
    std::list<PlaceTimes::Begun> bodies;
    for (int i = 0; i < 3; ++i) bodies.push_back(times.begin("a", begin));
    EXPECT_EQ(times.seconds_until_one_ends("a", begin), 1);
    EXPECT_EQ(times.seconds_until_one_ends("a", begin + seconds(40)), 10);  // three divide 40 s in four parts
    EXPECT_EQ(times.seconds_until_one_ends("b", begin + seconds(40)), 10);  // it has none: all count
    bodies.push_back(times.begin("b", begin + seconds(40)));
    EXPECT_EQ(times.seconds_until_one_ends("b", begin + seconds(46)), 3);
    EXPECT_EQ(times.seconds_until_one_ends("a", begin + seconds(46)), 12);  // 46 s / 4, rounded up
    EXPECT_EQ(times.seconds_until_one_ends("a", begin + seconds(10'000)), PlaceTimes::longest_s);
}

TEST(PlaceTimes, BodiesThatEndedTellHowLongOthersTake) {
    PlaceTimes times;
    const PlaceTimes::Clock::time_point now = PlaceTimes::Clock::now();
    { const auto ended = times.begin("a", now - seconds(20)); }
    const auto body = times.begin("a", now);
    EXPECT_NEAR(times.seconds_until_one_ends("a", now), 10, 1);  // half of 20 s; the clock goes on during the test
}

}  // namespace
}  // namespace hairbake
