// Progress and cancellation of a bake.
#pragma once

#include <atomic>
#include <string_view>

#include "core/base/error.h"

namespace hairbake {

/// Told by the stages how far they are, and asked by them whether to stop. Every member may be called from any thread.
class Progress {
public:
    virtual ~Progress() = default;

    /// `stage` is one of read_hair, transmittance, reference, read_environment, irradiance, write, render;
    /// `fraction` in [0, 1] of that stage. May be called often: the receiver thins out. Default: silent.
    virtual void report(std::string_view /*stage*/, double /*fraction*/) {}

    /// Asks the running bake to stop. Safe in a signal handler.
    void cancel() noexcept { cancelled_.store(true, std::memory_order_relaxed); }
    bool cancelled() const noexcept { return cancelled_.load(std::memory_order_relaxed); }

    /// Throws Error(cancelled) when a stop was asked for. Stages call it at least every 100 ms of work.
    void check() const {
        if (cancelled()) throw Error(ErrorKind::cancelled, "cancelled");
    }

private:
    std::atomic<bool> cancelled_{false};
};

}  // namespace hairbake
