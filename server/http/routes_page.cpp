#include <memory>

#include "server/http/page_files.h"
#include "server/http/routes.h"

namespace hairbake {

std::vector<Route> page_routes(const std::filesystem::path& folder) {
    const auto page = std::make_shared<const PageFiles>(folder);
    return {
        {"GET", "/", Scope::open, 0, [page](HttpRequest& request) { return page->index(request); }},
        {"GET", "/assets/{version}/{path...}", Scope::open, 0,
         [page](HttpRequest& request) { return page->asset(request); }},
    };
}

}  // namespace hairbake
