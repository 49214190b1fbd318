#include "clients/cli/progress_display.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <mutex>

#include "clients/cli/output.h"
#include "clients/cli/terminal.h"
#include "clients/cli/time_left.h"

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
        show({phase_, phase_fraction, fraction_, elapsed, left_.update(elapsed, fraction_)});
    }

protected:
    virtual void show(const Reading& reading) = 0;

private:
    std::vector<Phase> phases_;
    std::string phase_;
    double fraction_ = 0;
    TimeLeft left_;
    Clock::time_point start_ = Clock::now(), shown_{};
    std::mutex mutex_;
};

/// "transmittance, 12 s left".
std::string words_of(const Reading& reading) {
    std::string text(reading.phase);
    if (reading.left >= 0) text += ", " + std::to_string(static_cast<long>(reading.left + 0.99)) + " s left";
    return text;
}

/// One line that is written again and again; it fits into the terminal's width.
class Bar : public Display {
public:
    using Display::Display;
    ~Bar() override { std::fputs("\r\033[K", stderr); }

protected:
    void show(const Reading& reading) override {
        char percent[16];
        std::snprintf(percent, sizeof percent, "%3.0f %%  ", 100 * reading.fraction);
        const std::string words = percent + words_of(reading);
        const int room = columns() - 1;  // a full line would make some terminals begin another one
        constexpr int widest = 32, narrowest = 8;
        const int width = std::min(widest, room - static_cast<int>(words.size()) - 3);
        std::string line;
        if (width >= narrowest) {
            line.assign(static_cast<std::size_t>(std::lround(reading.fraction * width)), '#');
            line.resize(static_cast<std::size_t>(width), '.');
            line = "[" + line + "] ";
        }
        line = (line + words).substr(0, static_cast<std::size_t>(std::max(room, 0)));
        std::fprintf(stderr, "\r%s\033[K", line.c_str());
        std::fflush(stderr);
    }
};

/// For a terminal without escape codes: a line for each tenth of the work.
class PlainLines : public Display {
public:
    using Display::Display;

protected:
    void show(const Reading& reading) override {
        const int tenth = static_cast<int>(10 * reading.fraction);
        if (tenth <= tenth_) return;
        tenth_ = tenth;
        std::fprintf(stderr, "%d %%  %s\n", 10 * tenth, words_of(reading).c_str());
    }

private:
    int tenth_ = 0;
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
    if (mode == "auto" && understands_codes()) return std::make_unique<Bar>(phases);
    if (mode == "auto" && is_terminal()) return std::make_unique<PlainLines>(phases);
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
