#include "clients/cli/progress_display.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>

namespace hairbake {
namespace {

using Clock = std::chrono::steady_clock;

/// What a display shows.
struct Reading {
    std::string_view stage;
    double stage_fraction, fraction;
    double elapsed;  ///< seconds
    double left;     ///< seconds, negative while there is no estimate
};

/// Turns reports of stages into readings of the whole, a few a second.
class Display : public Progress {
public:
    explicit Display(const std::vector<PlannedStage>& stages) : stages_(stages) {
        for (const PlannedStage& stage : stages_) total_ += stage.share;
    }

    void report(std::string_view stage, double stage_fraction) final {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock) return;  // another thread shows something just as new
        const Clock::time_point now = Clock::now();
        if (now - shown_ < std::chrono::milliseconds(100) && stage_fraction > 0 && stage_fraction < 1) return;
        shown_ = now;
        fraction_ = std::max(fraction_, fraction_at(stage, stage_fraction));
        const double elapsed = std::chrono::duration<double>(now - start_).count();
        const bool known = fraction_ > 0.02 && elapsed > 0.2;
        show({stage, stage_fraction, fraction_, elapsed, known ? elapsed * (1 - fraction_) / fraction_ : -1});
    }

protected:
    virtual void show(const Reading& reading) = 0;

private:
    double fraction_at(std::string_view stage, double stage_fraction) const {
        double before = 0;
        for (const PlannedStage& planned : stages_) {
            if (planned.name == stage) return (before + planned.share * std::clamp(stage_fraction, 0.0, 1.0)) / total_;
            before += planned.share;
        }
        return 0;  // a stage that nobody planned moves nothing
    }

    std::vector<PlannedStage> stages_;
    double total_ = 0, fraction_ = 0;
    Clock::time_point start_ = Clock::now(), shown_{};
    std::mutex mutex_;
};

class Bar : public Display {
public:
    using Display::Display;
    ~Bar() override { std::fputs("\r\033[K", stderr); }

protected:
    void show(const Reading& reading) override {
        constexpr int width = 32;
        const auto filled = static_cast<int>(std::lround(reading.fraction * width));
        std::string bar(static_cast<std::size_t>(filled), '#');
        bar.resize(width, '.');
        std::string left;
        if (reading.left >= 0) left = ", " + std::to_string(static_cast<long>(reading.left + 0.99)) + " s left";
        std::fprintf(stderr, "\r[%s] %3.0f %%  %.*s%s\033[K", bar.c_str(), 100 * reading.fraction,
                     static_cast<int>(reading.stage.size()), reading.stage.data(), left.c_str());
        std::fflush(stderr);
    }
};

class JsonLines : public Display {
public:
    using Display::Display;

protected:
    void show(const Reading& reading) override {
        char left[32] = "null";
        if (reading.left >= 0) std::snprintf(left, sizeof left, "%.2f", reading.left);
        std::printf(
            "{\"event\":\"progress\",\"stage\":%s,\"stage_fraction\":%.4f,\"fraction\":%.4f,\"elapsed_s\":%.2f,"
            "\"left_s\":%s}\n",
            json_string(reading.stage).c_str(), reading.stage_fraction, reading.fraction, reading.elapsed, left);
        std::fflush(stdout);
    }
};

}  // namespace

std::unique_ptr<Progress> make_progress_display(const std::string& mode, const std::vector<PlannedStage>& stages) {
    if (mode == "json") return std::make_unique<JsonLines>(stages);
    if (mode == "auto" && isatty(STDERR_FILENO)) return std::make_unique<Bar>(stages);
    return std::make_unique<Progress>();
}

std::string json_string(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        char escape[8];
        if (c == '"' || c == '\\') {
            result += '\\';
            result += c;
        } else if (static_cast<unsigned char>(c) < 0x20) {
            std::snprintf(escape, sizeof escape, "\\u%04x", static_cast<unsigned>(c));
            result += escape;
        } else {
            result += c;
        }
    }
    return result + "\"";
}

}  // namespace hairbake
