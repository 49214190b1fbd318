// Preconditions that a function's comment promises, checked in builds with HAIRBAKE_ASSERTS (tests, sanitizers,
// fuzzing).
#pragma once

#include <cstdio>
#include <cstdlib>

namespace hairbake {

[[noreturn]] inline void assertion_failed(const char* condition, const char* file, int line) {
    std::fprintf(stderr, "%s:%d: the precondition does not hold: %s\n", file, line, condition);
    std::abort();
}

}  // namespace hairbake

// For errors of the caller alone: a wrong input is an Error, not an assertion. The condition must be cheap beside the
// function that it guards, and must have no side effect.
#ifdef HAIRBAKE_ASSERTS
#define HAIRBAKE_ASSERT(condition) \
    ((condition) ? void(0) : ::hairbake::assertion_failed(#condition, __FILE__, __LINE__))
#else
#define HAIRBAKE_ASSERT(condition) void(0)
#endif
