#include "clients/cli/progress_display.h"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>

#include "clients/cli/output.h"

namespace hairbake {
namespace {

using Clock = std::chrono::steady_clock;

/// The values that a display shows.
struct Reading {
    std::string_view phase;
    double phase_fraction, fraction;
    double elapsed;  ///< seconds
    double left;     ///< seconds, negative while there is no estimate
};

/// Turns reports of phases into readings of the whole, a few a second.
class Display : public BakeProgress {
public:
    explicit Display(const std::vector<Phase>& phases)
        : phases_(phases), phase_(phases.empty() ? "" : phases.front().name) {
        double sum = 0;
        for (const Phase& phase : phases_) sum += phase.share;
        for (Phase& phase : phases_) phase.share /= sum;
    }

    void enter(std::string_view phase) final {
        {
            const std::lock_guard lock(mutex_);
            phase_ = phase;
            shown_ = {};
        }
        report(0);
    }

    void report(double phase_fraction) final {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock) return;  // another thread shows a reading that is as new
        const Clock::time_point now = Clock::now();
        if (now - shown_ < std::chrono::milliseconds(100) && phase_fraction < 1) return;
        shown_ = now;
        fraction_ = std::max(fraction_, fraction_of_whole(phases_, phase_, phase_fraction));
        const double elapsed = std::chrono::duration<double>(now - start_).count();
        const bool known = fraction_ > 0.02 && elapsed > 0.2;
        show({phase_, phase_fraction, fraction_, elapsed, known ? elapsed * (1 - fraction_) / fraction_ : -1});
    }

protected:
    virtual void show(const Reading& reading) = 0;

private:
    std::vector<Phase> phases_;
    std::string phase_;
    double fraction_ = 0;
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
                     static_cast<int>(reading.phase.size()), reading.phase.data(), left.c_str());
        std::fflush(stderr);
    }
};

class JsonLines : public Display {
public:
    using Display::Display;

protected:
    void show(const Reading& reading) override {
        char left[32] = "null", line[256];
        if (reading.left >= 0) std::snprintf(left, sizeof left, "%.2f", reading.left);
        std::snprintf(line, sizeof line, "\"phase_fraction\":%.4f,\"fraction\":%.4f,\"elapsed_s\":%.2f,\"left_s\":%s}",
                      reading.phase_fraction, reading.fraction, reading.elapsed, left);
        print_line("{\"event\":\"progress\",\"phase\":" + json_string(reading.phase) + "," + line);
    }
};

}  // namespace

std::unique_ptr<BakeProgress> make_progress_display(const std::string& mode, const std::vector<Phase>& phases) {
    if (mode == "json") return std::make_unique<JsonLines>(phases);
    if (mode == "auto" && isatty(STDERR_FILENO)) return std::make_unique<Bar>(phases);
    return std::make_unique<BakeProgress>();
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
