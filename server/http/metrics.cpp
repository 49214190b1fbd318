#include "server/http/metrics.h"

#include <prometheus/counter.h>
#include <prometheus/gauge.h>
#include <prometheus/histogram.h>
#include <prometheus/registry.h>
#include <prometheus/text_serializer.h>

#include <mutex>

namespace hairbake {
namespace {

using Gauges = prometheus::Family<prometheus::Gauge>;

Gauges& gauges(prometheus::Registry& registry, const char* name, const char* help) {
    return prometheus::BuildGauge().Name(name).Help(help).Register(registry);
}

void set_states(Gauges& family, const std::map<JobState, std::int64_t>& states) {
    for (const auto& [state, count] : states) family.Add({{"state", name_of(state)}}).Set(static_cast<double>(count));
}

}  // namespace

struct Metrics::State {
    prometheus::Registry registry;
    prometheus::Family<prometheus::Counter>& requests = prometheus::BuildCounter()
                                                            .Name("hairbake_http_requests_total")
                                                            .Help("Requests answered, by method and status")
                                                            .Register(registry);
    prometheus::Family<prometheus::Histogram>& durations = prometheus::BuildHistogram()
                                                               .Name("hairbake_http_request_duration_seconds")
                                                               .Help("Time from a request's head to its reply's head")
                                                               .Register(registry);
    prometheus::Histogram& duration =
        durations.Add({}, prometheus::Histogram::BucketBoundaries{0.001, 0.01, 0.1, 1, 10});
    Gauges& bakes = gauges(registry, "hairbake_bakes", "Bakes by state");
    Gauges& stages = gauges(registry, "hairbake_stages", "Stages by state");
    prometheus::Gauge& blobs = gauges(registry, "hairbake_store_blobs", "Blobs in the store").Add({});
    Gauges& paused = gauges(registry, "hairbake_queue_paused",
                            "1 while the queue is paused because the machine is in trouble, with the reason");
    prometheus::Gauge* pause = nullptr;  ///< the one member of `paused`
    prometheus::Gauge& troubles =
        gauges(registry, "hairbake_machine_troubles", "How often the machine kept a stage from running since the start")
            .Add({});
    prometheus::Gauge& bytes = gauges(registry, "hairbake_store_bytes", "Bytes of all blobs").Add({});
    std::mutex mutex;  ///< of text()

    /// The reason is a label; a reason of the past is removed.
    void set_pause(const std::string& reason) {
        if (pause) paused.Remove(pause);
        pause = &paused.Add(reason.empty() ? prometheus::Labels{} : prometheus::Labels{{"reason", reason}});
        pause->Set(reason.empty() ? 0 : 1);
    }
};

Metrics::Metrics() : state_(std::make_unique<State>()) {}
Metrics::~Metrics() = default;

void Metrics::count(const std::string& method, int status, double seconds) {
    state_->requests.Add({{"method", method}, {"status", std::to_string(status)}}).Increment();
    state_->duration.Observe(seconds);
}

std::string Metrics::text(const Service::Counts& counts) {
    const std::lock_guard lock(state_->mutex);
    state_->set_pause(counts.paused);
    state_->troubles.Set(static_cast<double>(counts.troubles));
    set_states(state_->bakes, counts.bakes);
    set_states(state_->stages, counts.stages);
    state_->blobs.Set(static_cast<double>(counts.blobs));
    state_->bytes.Set(static_cast<double>(counts.bytes));
    return prometheus::TextSerializer().Serialize(state_->registry.Collect());
}

}  // namespace hairbake
