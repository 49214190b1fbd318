#include "server/jobs/task_follower.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <system_error>
#include <thread>

#include "server/store/store_advice.h"

namespace hairbake {
namespace {

using Clock = std::chrono::steady_clock;
using End = Outcome::End;
using State = RunStatus::State;

/// A short task is asked about often, a long one every 25 ms.
void sleep_until_next_poll(Clock::duration running) {
    using namespace std::chrono_literals;
    std::this_thread::sleep_for(std::clamp<Clock::duration>(running / 16, 1ms, 25ms));
}

Outcome outcome_of(const LastWord& word, bool was_stopped) {
    if (!word.error) return {End::done, word.facts, {}, {}, {}, false};
    End end = word.is_trouble ? End::trouble : End::failed;
    if (*word.error == ErrorKind::cancelled)
        end = was_stopped ? End::cancelled : End::died;  // somebody else stopped it
    return {end, word.facts, *word.error, word.message, word.field, end == End::died};
}

/// Why the work folder cannot be used any more: errno, or 0.
int error_of_folder(const WorkFolder& folder) { return ::access(folder.path().c_str(), W_OK | X_OK) == 0 ? 0 : errno; }

Outcome trouble_with(const std::string& what, const std::filesystem::path& file, int error) {
    const std::string advice = error == ENOENT ? "" : ". " + advice_for(file, error);
    return {
        End::trouble, "{}", ErrorKind::out_of_resources, what + ": " + std::generic_category().message(error) + advice,
        {},           false};
}

/// `program` is the worker's. `was_stopped`: on the caller's wish.
Outcome conclude(const RunStatus& status, const WorkerWords& words, const WorkFolder& folder,
                 const std::string& program, bool was_stopped) {
    if (status.state == State::exited && words.last_word() && !words.is_babbling())
        return outcome_of(*words.last_word(), was_stopped);
    if (was_stopped) return {End::cancelled, "{}", ErrorKind::cancelled, {}, {}, false};
    if (words.is_babbling())
        return {End::died,
                "{}",
                ErrorKind::internal,
                "the worker wrote a line of more than 1 MiB or more than 64 MiB of words",
                {},
                false};
    if (status.state == State::over_limit)
        return {End::failed, "{}", ErrorKind::out_of_resources, status.message, {}, false};
    if (words.trouble()) return trouble_with("the worker's words cannot be read", folder.words(), words.trouble());
    if (const int error = error_of_folder(folder)) return trouble_with("the work folder is gone", folder.path(), error);
    if (!words.has_begun())
        return {End::trouble,
                "{}",
                ErrorKind::internal,
                status.message + " before it reached its task; its program is " + program,
                {},
                false};
    const std::string without = status.state == State::exited ? " without a result" : "";
    return {End::died, "{}", ErrorKind::internal, status.message + without, {}, status.from_outside};
}

}  // namespace

Outcome follow_task(Runner& runner, const std::string& handle, const WorkFolder& folder,
                    const std::function<Wish()>& wish, const WorkerWords::OnProgress& on_progress) {
    const Clock::time_point begin = Clock::now();
    WorkerWords words(folder.words(), on_progress);
    bool was_stopped = false;
    for (;;) {
        const Wish wanted = wish();
        if (wanted == Wish::leave) return {End::left, "{}", {}, {}, {}, false};
        if (wanted == Wish::stop && !was_stopped) {
            was_stopped = true;
            runner.stop(handle);
        }
        const RunStatus status = runner.poll(handle);  // before the words: the last one is written before the end
        const bool more = words.read_more();
        if (status.state != State::running) {
            while (words.read_more()) {
            }
            return conclude(status, words, folder, runner.program(), was_stopped);
        }
        if (words.is_babbling()) runner.stop(handle);
        if (!more) sleep_until_next_poll(Clock::now() - begin);
    }
}

}  // namespace hairbake
