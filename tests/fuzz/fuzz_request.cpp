// Any bytes as a request. They are refused as a usage error, or taken; a taken request is written and then reads the
// same.
#include <cstdint>
#include <string_view>

#include "core/base/error.h"
#include "core/request/request_json.h"
#include "core/request/stages.h"
#include "tests/fuzz/demand.h"

namespace {

using namespace hairbake;

void check_request(const BakeRequest& request) {
    const std::string text = to_json(request);
    BakeRequest again;
    merge_json(again, text, "written");
    demand(to_json(again) == text, "a written request reads the same");
    for (const Stage& stage : stages())
        demand(stage_key(stage, {}, again) == stage_key(stage, {}, request), "equal requests have equal keys");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    BakeRequest request;
    try {
        merge_json(request, {reinterpret_cast<const char*>(data), size}, "fuzz");
        check_request(request);
        validate(request);
    } catch (const Error& error) {
        demand(error.kind() == ErrorKind::usage, "an input's fault is a usage error");
    }
    return 0;
}
