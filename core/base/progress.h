// Progress and cancellation: how far a piece of work is, and whether it shall stop.
#pragma once

#include <atomic>
#include <string_view>

#include "core/base/error.h"

namespace hairbake {

class ProgressPart;

/// A function that takes long gets one of these, reports its own progress from 0 to 1, and asks whether to stop. It
/// knows neither the name of its phase nor its share of the whole. Every member may be called from any thread.
class Progress {
public:
    Progress() = default;
    virtual ~Progress() = default;
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// `fraction` in [0, 1] of the work of this object. May be called often: the receiver passes on only some of the
    /// reports. Default: silent.
    virtual void report(double /*fraction*/) {}

    /// Asks the work to stop. Safe in a signal handler. Call it only on the object that the outermost caller made.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
    virtual bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

    /// Call it at least every 100 ms of work.
    /// Throws Error(cancelled) when a stop was asked for.
    void check() const {
        if (cancelled()) throw Error(ErrorKind::cancelled, "cancelled");
    }

    /// The share [from, to] of this work, for a callee that reports 0 to 1 of its own. Must not outlive this object.
    ProgressPart part(double from, double to);

private:
    std::atomic<bool> cancelled_{false};
};

/// A share of another Progress. A cancel of that one cancels this one.
class ProgressPart final : public Progress {
public:
    ProgressPart(Progress& whole, double from, double to) : whole_(whole), from_(from), to_(to) {}
    void report(double fraction) override { whole_.report(from_ + (to_ - from_) * fraction); }
    bool cancelled() const noexcept override { return whole_.cancelled(); }

private:
    Progress& whole_;
    double from_, to_;
};

inline ProgressPart Progress::part(double from, double to) { return {*this, from, to}; }

/// The progress that the facade (bake, write_result, render) takes. enter() names the phase that begins. report() then
/// gives the fraction of that phase. core/request/stages.h has the names of the phases and their shares of the whole.
class BakeProgress : public Progress {
public:
    /// Called by one thread at a time, before the first report of the phase. Default: silent.
    virtual void enter(std::string_view /*phase*/) {}
};

}  // namespace hairbake
