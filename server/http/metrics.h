// Counters for /metrics, in Prometheus' text format.
#pragma once

#include <memory>
#include <string>

#include "server/jobs/service.h"

namespace hairbake {

/// Thread-safe.
class Metrics {
public:
    Metrics();
    ~Metrics();

    /// Counts one request.
    void count(const std::string& method, int status, double seconds);
    std::string text(const Service::Counts& counts);

private:
    struct State;
    std::unique_ptr<State> state_;
};

}  // namespace hairbake
