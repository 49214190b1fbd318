// Runs a program from the shell: its exit code and its output.
#pragma once

#include <sys/wait.h>

#include <cstdio>
#include <stdexcept>
#include <string>

namespace hairbake::test_support {

struct Finished {
    int exit_code = -1;  ///< 128 + signal when a signal ended it
    std::string output;  ///< standard output; with "2>&1" in the command, both
};

/// `command` is a line for /bin/sh.
inline Finished run_program(const std::string& command) {
    std::FILE* pipe = ::popen(command.c_str(), "r");
    if (!pipe) throw std::runtime_error("cannot run " + command);
    Finished finished;
    char buffer[4096];
    while (const std::size_t n = std::fread(buffer, 1, sizeof buffer, pipe)) finished.output.append(buffer, n);
    const int status = ::pclose(pipe);
    finished.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return finished;
}

/// `text` as one word for /bin/sh.
inline std::string shell_word(const std::string& text) {
    std::string word = "'";
    for (const char c : text) word += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return word + "'";
}

/// Runs a Python script (Debian's python3, with numpy) with arguments.
inline Finished run_python(const std::string& script, const std::string& arguments) {
    return run_program("/usr/bin/python3 -c " + shell_word(script) + " " + arguments + " 2>&1");
}

}  // namespace hairbake::test_support
