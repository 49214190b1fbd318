// All routes of the service; one function for each group.
#pragma once

#include <filesystem>
#include <vector>

#include "server/http/json_bodies.h"
#include "server/http/metrics.h"
#include "server/http/router.h"
#include "server/jobs/service.h"

namespace hairbake {

std::vector<Route> input_routes(Service& service, JsonBodies& bodies);  ///< blobs, models, environments, names
std::vector<Route> bake_routes(Service& service, JsonBodies& bodies);   ///< bakes, rebakes, batches
std::vector<Route> upload_routes(Service& service);                     ///< tus
std::vector<Route> page_routes(const std::filesystem::path& folder);    ///< the web page
std::vector<Route> service_routes(Service& service, Access& access, Metrics& metrics);  ///< health, version, session

std::vector<Route> all_routes(Service& service, JsonBodies& bodies, Access& access, Metrics& metrics);

/// A number of the query in [low, high]; `otherwise` when it is not given.
/// Throws Refusal(unprocessable).
std::int64_t number_in_query(const HttpRequest& request, const std::string& name, std::int64_t low, std::int64_t high,
                             std::int64_t otherwise);

/// Whether the query's value of the name is 1. It may be 0 or missing.
/// Throws Refusal(unprocessable) for any other value.
bool flag_in_query(const HttpRequest& request, const std::string& name);

}  // namespace hairbake
