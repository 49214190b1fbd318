// Restarts of the service with a runner whose workers go on without the daemon.
#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/base/digest.h"
#include "core/request/request_json.h"
#include "server/jobs/service.h"
#include "server/jobs/stage_plan.h"
#include "tests/support/temporary_folder.h"

namespace hairbake {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// Jobs that outlive the daemon. The test plays the workers.
struct Farm {
    struct Job {
        fs::path folder;
        bool is_stopped = false;
        RunStatus status;
    };
    std::mutex mutex;
    std::map<std::string, Job> jobs;  ///< by handle
};

class FarmRunner : public Runner {
public:
    explicit FarmRunner(Farm& farm) : farm_(farm) {}

    std::string start(const fs::path& work_folder) override {
        const std::lock_guard lock(farm_.mutex);
        const std::string handle = "job " + std::to_string(farm_.jobs.size());
        farm_.jobs[handle].folder = work_folder;
        return handle;
    }
    RunStatus poll(const std::string& handle) override {
        const std::lock_guard lock(farm_.mutex);
        return farm_.jobs.at(handle).status;
    }
    void stop(const std::string& handle) override {
        const std::lock_guard lock(farm_.mutex);
        farm_.jobs.at(handle).is_stopped = true;
        farm_.jobs.at(handle).status = {RunStatus::State::killed, "stopped"};
    }
    void check_ready() override {}
    bool survives_restart() const override { return true; }

private:
    Farm& farm_;
};

class RestartTest : public ::testing::Test {
protected:
    RestartTest() {
        settings.store = folder / "store";
        settings.runner = "farm";
        settings.workers = 1;
        boot();
    }

    void boot() { service = std::make_unique<Service>(settings, std::make_unique<FarmRunner>(farm)); }

    std::string put(const std::string& text) {
        const auto file = service->receive(text.size());
        file->add(std::as_bytes(std::span(text)));
        service->store_blob(*file, "");
        return file->digest();
    }

    std::string state() { return Json::parse(service->bakes().get(bake).json)["state"]; }

    /// Waits for a job of the farm; returns its work folder.
    fs::path folder_of(const std::string& handle) {
        fs::path found;
        wait([&] {
            const std::lock_guard lock(farm.mutex);
            if (farm.jobs.count(handle)) found = farm.jobs[handle].folder;
            return !found.empty();
        });
        return found;
    }

    void end(const std::string& handle) {
        const std::lock_guard lock(farm.mutex);
        farm.jobs.at(handle).status = {RunStatus::State::exited, "the worker ended with code 0"};
    }

    template <class Condition>
    static void wait(const Condition& condition) {
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (!condition()) {
            ASSERT_LT(std::chrono::steady_clock::now(), end) << "nothing happened";
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
    }

    /// Plays a worker that was successful: one file, and a manifest with the stage's key.
    static void write_result(const fs::path& work_folder, const StagePlan& stage) {
        fs::create_directory(work_folder / "result");
        std::ofstream(work_folder / "result/x.npy") << "result";
        const std::string digest = Digest().add("result").hex();
        Json manifest{{"timings_s", Json::object()}};
        manifest["stages"][stage.kind]["key"] = stage.core_key;
        manifest["files"][0] = Json{{"name", "x.npy"}, {"sha256", digest}, {"bytes", 6}};
        std::ofstream(work_folder / "result/manifest.json") << manifest;
        std::ofstream(work_folder / "words.jsonl", std::ios::app)
            << "{\"phase\":\"write\",\"fraction\":1}\n{\"done\":{}}\n";
    }

    test_support::TemporaryFolder folder;
    Settings settings;
    Farm farm;
    std::unique_ptr<Service> service;
    std::string bake;
};

TEST_F(RestartTest, AWorkerThatOutlivesTheDaemonIsFollowedByTheNext) {
    const std::string request = R"({"hair": "sha256:)" + put("hair") + R"("})";
    bake = service->submit(request).id;
    BakeRequest parsed;
    merge_json(parsed, request, "the request");
    const StagePlan stage = plan_bake(parsed).stages.at(0);
    const fs::path work_folder = folder_of("job 0");
    const Json task = Json::parse(std::ifstream(work_folder / "task.json"));
    EXPECT_EQ(task["stages"], Json{stage.kind});
    wait([&] { return state() == "running"; });

    service.reset();
    EXPECT_FALSE(farm.jobs.at("job 0").is_stopped);
    EXPECT_TRUE(fs::exists(work_folder));
    const fs::path left_over = folder / "store/tmp" / std::string(32, 'a');
    fs::create_directories(left_over);  // of a worker that did not survive
    boot();
    EXPECT_EQ(state(), "running");
    EXPECT_TRUE(fs::exists(work_folder / "task.json"));
    EXPECT_FALSE(fs::exists(left_over));

    service.reset();
    write_result(work_folder, stage);  // it ends while there is no daemon
    end("job 0");
    boot();
    wait([&] { return state() == "done"; });
    EXPECT_EQ(farm.jobs.size(), 1u);
    EXPECT_FALSE(fs::exists(work_folder));
    EXPECT_EQ(service->bakes().file(bake, "x.npy").etag, Digest().add("result").hex());
}

TEST_F(RestartTest, AWorkerWhoseFolderIsGoneIsStartedAgain) {
    bake = service->submit(R"({"hair": "sha256:)" + put("hair") + R"("})").id;
    const fs::path work_folder = folder_of("job 0");
    wait([&] { return state() == "running"; });
    service.reset();
    fs::remove_all(work_folder);
    boot();
    EXPECT_NE(folder_of("job 1"), work_folder);
}

TEST_F(RestartTest, ACancelledBakeStopsItsWorkerAfterARestartToo) {
    bake = service->submit(R"({"hair": "sha256:)" + put("hair") + R"("})").id;
    const fs::path work_folder = folder_of("job 0");
    wait([&] { return state() == "running"; });
    service.reset();
    boot();
    service->cancel(bake);
    wait([&] { return !fs::exists(work_folder); });
    EXPECT_TRUE(farm.jobs.at("job 0").is_stopped);
    EXPECT_EQ(state(), "cancelled");
}

}  // namespace
}  // namespace hairbake
