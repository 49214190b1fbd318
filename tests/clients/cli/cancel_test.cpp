// Signals sent to the real program in the middle of a bake.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <thread>

#include "tests/clients/cli/cli.h"

namespace hairbake::test_support {
namespace {

using Clock = std::chrono::steady_clock;

/// Whether hairbake runs there and has blocked SIGINT, SIGTERM and, unless ignored, SIGHUP, and these alone: from then
/// on a signal is seen to. Before that it ends the program as it ends any other; a library that starts up blocks all
/// signals for a moment.
bool is_ready(pid_t child, bool without_hangup) {
    const unsigned long long blocked =
        (1ull << (SIGINT - 1)) | (1ull << (SIGTERM - 1)) | (without_hangup ? 0 : 1ull << (SIGHUP - 1));
    std::ifstream status("/proc/" + std::to_string(child) + "/status");
    std::string word, name;
    status >> word >> name;
    while (status >> word)
        if (word == "SigBlk:" && status >> word) return name == "hairbake" && std::stoull(word, nullptr, 16) == blocked;
    return false;
}

/// Starts the program with its output thrown away and waits until it is ready.
pid_t start(const std::string& arguments, int ignored = 0) {
    const std::string command = "exec " + shell_word(HAIRBAKE_PROGRAM) + " " + arguments + " >/dev/null 2>&1";
    const pid_t child = ::fork();
    if (child == 0) {
        ::signal(SIGHUP, SIG_DFL);  // the tests may run under nohup
        if (ignored) ::signal(ignored, SIG_IGN);
        ::execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
        ::_exit(127);
    }
    while (!is_ready(child, ignored == SIGHUP)) std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return child;
}

struct Ended {
    int exit_code;
    double seconds;
};

/// Sends the signal and waits; `seconds` is the time from the signal to the end.
Ended stop(pid_t child, int signal_number) {
    const auto sent = Clock::now();
    ::kill(child, signal_number);
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
            std::chrono::duration<double>(Clock::now() - sent).count()};
}

const std::string traced = " --directions 4096 --set transmittance.method=trace";

class Cancel : public testing::TestWithParam<std::pair<int, int>> {};

// A traced bake of this size takes minutes, so the signal comes in the middle of it whatever the delay.
TEST_P(Cancel, EndsTheBakeSoonWithFiveAndLeavesNothing) {
    const auto [signal_number, delay_ms] = GetParam();
    const Workshop workshop;
    ASSERT_EQ(hairbake("sample " + workshop.path("samples") + " --vertices 300000 --map-width 64").exit_code, 0);
    const pid_t child = start("bake" + workshop.hair() + workshop.env() + workshop.out() + traced);
    std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
    const Ended ended = stop(child, signal_number);
    EXPECT_EQ(ended.exit_code, 5);
    RecordProperty("seconds", std::to_string(ended.seconds));
    std::printf("ended %.2f s after the signal\n", ended.seconds);
    EXPECT_LT(ended.seconds, 10) << "a second is promised; the rest is for a machine under load";
    EXPECT_EQ(workshop.names(), std::vector<std::string>{"samples"});
}

INSTANTIATE_TEST_SUITE_P(Signals, Cancel,
                         testing::Values(std::pair(SIGINT, 0), std::pair(SIGINT, 700), std::pair(SIGTERM, 700),
                                         std::pair(SIGHUP, 700)));

TEST(CancelWhileWriting, LeavesTheEarlierResultAlone) {
    const Workshop workshop;
    ASSERT_EQ(hairbake("bake" + workshop.env() + workshop.out() + " --preset draft").exit_code, 0);
    const auto before = json_of(workshop.path("out/manifest.json"))["id"];
    // 257 maps are 516 EXR files, each flushed to the disk; the staging folder shows that writing has begun.
    const pid_t child = start("bake" + workshop.env() + workshop.out() + " --specular-maps 257");
    while (workshop.names().size() < 3) {
        ASSERT_EQ(::waitpid(child, nullptr, WNOHANG), 0) << "the bake ended before it wrote";
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    EXPECT_EQ(stop(child, SIGINT).exit_code, 5);
    EXPECT_EQ(workshop.names(), (std::vector<std::string>{"out", "samples"}));
    EXPECT_EQ(json_of(workshop.path("out/manifest.json"))["id"], before);
}

TEST(CancelIgnoredSignal, AnIgnoredSigintOfABackgroundJobStillStopsTheBake) {
    const Workshop workshop;
    const pid_t child = start("bake" + workshop.hair() + workshop.out() + traced, SIGINT);
    EXPECT_EQ(stop(child, SIGINT).exit_code, 5);
}

TEST(CancelIgnoredSignal, AnIgnoredSighupOfNohupDoesNotStopTheBake) {
    const Workshop workshop;
    ASSERT_EQ(hairbake("sample " + workshop.path("samples") + " --vertices 300000 --map-width 64").exit_code, 0);
    const pid_t child = start("bake" + workshop.hair() + workshop.out() + traced, SIGHUP);
    ::kill(child, SIGHUP);
    std::this_thread::sleep_for(std::chrono::milliseconds(300));  // ten times as long as the program looks for signals
    EXPECT_EQ(::waitpid(child, nullptr, WNOHANG), 0);
    EXPECT_EQ(stop(child, SIGTERM).exit_code, 5);
}

TEST(CancelOverdue, WorkThatDoesNotListenIsEndedAllTheSame) {
    const Workshop workshop;
    // Growing a groom does not ask for cancellation; 30 million vertices take many seconds.
    const pid_t child = start("sample " + workshop.path("large") + " --vertices 30000000");
    const Ended ended = stop(child, SIGINT);
    EXPECT_EQ(ended.exit_code, 5);
    EXPECT_FALSE(std::filesystem::exists(workshop.path("large/groom.hair")));
    EXPECT_FALSE(std::filesystem::exists(workshop.path("large/.part-groom.hair")));
}

TEST(CancelOverdue, ASecondSignalInTheMiddleOfASampleFileLeavesNoPartOfIt) {
    const Workshop workshop;
    const auto part_of = [&](const char* name) {
        return std::filesystem::exists(workshop.path(std::string("large/.part-") + name));
    };
    const pid_t child = start("sample " + workshop.path("large") + " --vertices 300 --map-width 4096");
    while (!part_of("sky.hdr") && !part_of("studio.hdr")) {
        ASSERT_EQ(::waitpid(child, nullptr, WNOHANG), 0) << "the samples were written before one was seen";
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    // Until one comes after the first was seen to, and ends the program where it stands.
    int status = 0;
    while (::waitpid(child, &status, WNOHANG) == 0) {
        ::kill(child, SIGINT);
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_EQ(WEXITSTATUS(status), 5);
    for (const char* name : {"sky.hdr", "studio.hdr", "overcast.hdr"}) EXPECT_FALSE(part_of(name)) << name;
    EXPECT_FALSE(std::filesystem::exists(workshop.path("large/overcast.hdr")));
}

}  // namespace
}  // namespace hairbake::test_support
