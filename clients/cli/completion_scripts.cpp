#include <map>

#include "clients/cli/completion.h"
#include "core/request/field_facts.h"

namespace hairbake {
namespace {

std::string joined(const std::vector<std::string>& words, const std::string& between = " ") {
    std::string text;
    for (const std::string& word : words) text += (text.empty() ? "" : between) + word;
    return text;
}

/// `text` with a backslash before each of `characters`.
std::string with_backslashes(const std::string& text, const std::string& characters) {
    std::string result;
    for (const char c : text) {
        if (characters.find(c) != std::string::npos) result += '\\';
        result += c;
    }
    return result;
}

/// `text` in single quotes for bash and zsh.
std::string quoted(const std::string& text) {
    std::string result = "'";
    for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return result + "'";
}

/// The fields of the request that allow words.
std::vector<FieldFacts> fields_with_words() {
    std::vector<FieldFacts> fields;
    for (FieldFacts& facts : field_facts())
        if (!facts.words.empty()) fields.push_back(std::move(facts));
    return fields;
}

std::vector<std::string> with_sign(std::vector<std::string> paths) {
    for (std::string& path : paths) path += '=';
    return paths;
}

// ---- bash ----------------------------------------------------------------------------------------------------------

/// The statement that offers what `option` takes.
std::string bash_offer(const CompletedOption& option) {
    switch (option.completes) {
        case Completes::file:
            return "_hairbake_files -f";
        case Completes::folder:
            return "_hairbake_files -d";
        case Completes::words:
            return "_hairbake_words " + quoted(joined(option.words));
        case Completes::list:
            return "_hairbake_list " + quoted(joined(option.words));
        case Completes::field:
            return "compopt -o nospace; _hairbake_words " + quoted(joined(with_sign(option.words)));
        default:
            return ":";
    }
}

constexpr const char* bash_beginning =
    R"(# bash completion of hairbake. `hairbake completion bash` prints it; source it.

_hairbake_words() { mapfile -t COMPREPLY < <(compgen -W "$1" -- "$word"); }
_hairbake_files() {
    compopt -o filenames
    mapfile -t COMPREPLY < <(compgen "$1" -- "$word")
}
# Words with commas between them.
_hairbake_list() {
    local before=
    [[ $word != *,* ]] || before=${word%,*},
    compopt -o nospace
    mapfile -t COMPREPLY < <(compgen -P "$before" -W "$1" -- "${word##*,}")
}
# What follows "PATH=" of --set.
_hairbake_field() {
    case $1 in
)";

constexpr const char* bash_middle = R"(    esac
}

_hairbake() {
    local word=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}
    COMPREPLY=()
    # bash takes "=" for a word of its own.
    if [[ $word == = ]]; then
        word=
    elif [[ $previous == = ]]; then
        previous=${COMP_WORDS[COMP_CWORD - 2]}
    fi
    if [[ ${COMP_WORDS[COMP_CWORD - 1]} == = && $previous != --* ]]; then
        _hairbake_field "$previous"
        return
    fi
    if ((COMP_CWORD == 1)); then
)";

}  // namespace

std::string bash_completion(const std::vector<CompletedCommand>& commands) {
    std::string text = bash_beginning;
    for (const FieldFacts& facts : fields_with_words())
        text += "        " + facts.path + ") " + (facts.is_list ? "_hairbake_list " : "_hairbake_words ") +
                quoted(joined(facts.words)) + " ;;\n";
    text += bash_middle;
    std::vector<std::string> names;
    for (const CompletedCommand& command : commands) names.push_back(command.name);
    text += "        _hairbake_words " + quoted(joined(names) + " --help --version") + "\n        return\n    fi\n";
    text += "    case $command:$previous in\n";
    for (const CompletedCommand& command : commands)
        for (const CompletedOption& option : command.options)
            if (option.completes != Completes::flag)
                text += "        " + command.name + ":" + option.name + ") " + bash_offer(option) + "; return ;;\n";
    text += "    esac\n    case $command in\n";
    for (const CompletedCommand& command : commands) {
        std::vector<std::string> options;
        for (const CompletedOption& option : command.options) options.push_back(option.name);
        text += "        " + command.name + ")\n            if [[ $word == -* ]]; then _hairbake_words " +
                quoted(joined(options)) + "; else ";
        text += (command.arguments.empty() ? ":" : bash_offer(command.arguments.front())) + "; fi ;;\n";
    }
    return text + "    esac\n}\ncomplete -F _hairbake hairbake\n";
}

// ---- zsh -----------------------------------------------------------------------------------------------------------

namespace {

/// What follows the help in a specification of _arguments.
std::string zsh_action(const CompletedOption& option) {
    switch (option.completes) {
        case Completes::flag:
            return "";
        case Completes::file:
            return ":file:_files";
        case Completes::folder:
            return ":folder:_files -/";
        case Completes::words:
            return ":value:(" + joined(option.words) + ")";
        case Completes::list:
            return ":list:_values -s , value " + joined(option.words);
        case Completes::field:
            return ":field:_hairbake_fields";
        default:
            return ":value: ";
    }
}

std::string zsh_specification(const CompletedOption& option) {
    if (option.name.empty()) return quoted((option.repeats ? "*" : "") + zsh_action(option));
    return quoted((option.repeats ? "*" : "") + option.name + "[" + with_backslashes(option.help, "[]:\\") + "]" +
                  zsh_action(option));
}

}  // namespace

std::string zsh_completion(const std::vector<CompletedCommand>& commands) {
    std::string text =
        "#compdef hairbake\n# zsh completion of hairbake. `hairbake completion zsh` prints it; put it into "
        "a folder of $fpath as _hairbake.\n\n";
    text += "_hairbake_fields() {\n    if compset -P '*='; then\n        case ${IPREFIX%=} in\n";
    for (const FieldFacts& facts : fields_with_words())
        text += "            *" + facts.path + ") compadd -- " + joined(facts.words) + " ;;\n";
    text += "        esac\n    else\n        compadd -S '' -- ";
    std::vector<std::string> paths;
    for (const FieldFacts& facts : field_facts()) paths.push_back(facts.path);
    text += joined(with_sign(paths)) + "\n    fi\n}\n\n_hairbake() {\n    local -a commands\n    commands=(\n";
    for (const CompletedCommand& command : commands)
        text += "        " + quoted(command.name + ":" + with_backslashes(command.help, ":\\")) + "\n";
    text +=
        "    )\n    if ((CURRENT == 2)); then\n        _describe command commands\n        return\n    fi\n"
        "    local command=$words[2]\n    shift words\n    ((CURRENT--))\n    case $command in\n";
    for (const CompletedCommand& command : commands) {
        text += "        " + command.name + ")\n            _arguments";
        for (const auto* list : {&command.options, &command.arguments})
            for (const CompletedOption& option : *list) text += " \\\n                " + zsh_specification(option);
        text += "\n            ;;\n";
    }
    return text +
           "    esac\n}\n\nif [[ $funcstack[1] == _hairbake ]]; then _hairbake \"$@\"; else compdef _hairbake "
           "hairbake; fi\n";
}

// ---- fish ----------------------------------------------------------------------------------------------------------

namespace {

std::string fish_quoted(const std::string& text) { return "'" + with_backslashes(text, "'\\") + "'"; }

/// What follows the name of an option in `complete`.
std::string fish_value(const CompletedOption& option) {
    switch (option.completes) {
        case Completes::flag:
            return "";
        case Completes::file:
            return " -r -F";
        case Completes::folder:
            return " -x -a '(__fish_complete_directories)'";
        case Completes::words:
            return " -x -a " + fish_quoted(joined(option.words));
        case Completes::list:
            return " -x -a '(__fish_append , " + joined(option.words) + ")'";
        case Completes::field:
            return " -x -a " + fish_quoted("(__hairbake_fields)");
        default:
            return " -x";
    }
}

}  // namespace

std::string fish_completion(const std::vector<CompletedCommand>& commands) {
    std::string text =
        "# fish completion of hairbake. `hairbake completion fish` prints it; put it into "
        "~/.config/fish/completions/hairbake.fish.\n\nfunction __hairbake_fields\n";
    std::vector<std::string> paths, values;
    for (const FieldFacts& facts : field_facts()) {
        paths.push_back(facts.path);
        for (const std::string& word : facts.words) values.push_back(facts.path + "=" + word);
    }
    text += "    printf '%s\\n' " + joined(with_sign(paths)) + "\n    printf '%s\\n' " + joined(values) + "\nend\n\n";
    text +=
        "complete -c hairbake -f\ncomplete -c hairbake -n __fish_use_subcommand -l help -d 'Print the help'\n"
        "complete -c hairbake -n __fish_use_subcommand -l version -d 'Print the version'\n";
    for (const CompletedCommand& command : commands)
        text += "complete -c hairbake -n __fish_use_subcommand -a " + command.name + " -d " +
                fish_quoted(command.help) + "\n";
    for (const CompletedCommand& command : commands) {
        const std::string here = "complete -c hairbake -n '__fish_seen_subcommand_from " + command.name + "'";
        for (const CompletedOption& option : command.options)
            text +=
                here + " -l " + option.name.substr(2) + fish_value(option) + " -d " + fish_quoted(option.help) + "\n";
        for (const CompletedOption& argument : command.arguments)
            if (argument.completes == Completes::file)
                text += here + " -F\n";
            else if (argument.completes != Completes::nothing)
                text += here + fish_value(argument) + "\n";
    }
    return text;
}

}  // namespace hairbake
