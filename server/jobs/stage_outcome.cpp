#include "server/jobs/stage_outcome.h"

#include <nlohmann/json.hpp>

#include "core/base/error.h"
#include "core/base/json_reason.h"
#include "server/store/file_system.h"

namespace hairbake {
namespace {

using End = Outcome::End;

Outcome outcome(End end, ErrorKind kind, const std::string& message, const std::string& field = {}) {
    return {end, "{}", kind, message, field, false};
}

}  // namespace

Outcome outcome_of_exception() {
    try {
        throw;
    } catch (const WrongResult& wrong) {
        return outcome(End::died, ErrorKind::internal, wrong.what());
    } catch (const ResultTooLarge& large) {
        return outcome(End::failed, ErrorKind::out_of_resources, large.what());
    } catch (const nlohmann::json::exception& wrong) {  // a manifest that lacks members
        return outcome(End::died, ErrorKind::internal,
                       "the worker's manifest is not of the known form: " + json_reason(wrong));
    } catch (const Error& error) {
        const bool of_input = error.kind() == ErrorKind::bad_input || error.kind() == ErrorKind::usage;
        return outcome(of_input && error.system_error() == 0 ? End::failed : End::trouble, error.kind(), error.what(),
                       error.field());
    } catch (const std::exception& error) {
        return outcome(End::trouble, ErrorKind::out_of_resources, error_text(error));
    }
}

}  // namespace hairbake
