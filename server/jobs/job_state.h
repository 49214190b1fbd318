// The states of stages and bakes. docs/architecture.md draws the transitions.
#pragma once

#include "core/base/names.h"

namespace hairbake {

enum class JobState { queued, running, done, failed, cancelled };

/// As the database and the HTTP replies have them.
inline constexpr std::array job_states{EnumName{JobState::queued, "queued"}, EnumName{JobState::running, "running"},
                                       EnumName{JobState::done, "done"}, EnumName{JobState::failed, "failed"},
                                       EnumName{JobState::cancelled, "cancelled"}};

inline std::string name_of(JobState state) { return std::string(name_in(job_states, state)); }

/// Nothing for a text that names no state.
inline std::optional<JobState> job_state(std::string_view name) { return find_in(job_states, name); }

/// Whether the job still has to end.
constexpr bool is_live(JobState state) { return state == JobState::queued || state == JobState::running; }

}  // namespace hairbake
