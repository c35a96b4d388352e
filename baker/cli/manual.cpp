#include "cli/manual.h"

#include "base/common/version.h"
#include "cli/help_format.h"
#include "cli/usage_error.h"

#include <fmt/format.h>
#include <vector>

namespace pliant {
namespace {

std::string replaced(std::string text, const std::string& from, const std::string& to)
{
    for (std::size_t at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
    return text;
}

// -- troff

std::string troff(const std::string& text)
{
    std::string out = replaced(replaced(text, "\\", "\\e"), "-", "\\-");
    out = replaced(out, "\n.", "\n\\&.");
    out = replaced(out, "\n'", "\n\\&'");
    return !out.empty() && (out[0] == '.' || out[0] == '\'') ? "\\&" + out : out;
}

std::string option_paragraph(const CLI::Option& option)
{
    const OptionValue value = shown_value(option);
    std::string head = troff(option.get_name(option.get_positional(), true));
    std::string out = ".TP\n.B " + replaced(head, ",", ", ");
    if (!value.type.empty() && !option.get_positional()) out += " \\fI" + troff(value.type) + "\\fR";
    out += "\n" + troff(option.get_description());
    if (!value.fallback.empty()) out += " (default: " + troff(value.fallback) + ")";
    return out + "\n";
}

std::string verb_section(const CLI::App& verb)
{
    std::string out = fmt::format(".SS pliant {}\n{}.\n", troff(verb.get_name()), troff(verb.get_description()));
    for (const CLI::Option* option : verb.get_options()) out += option_paragraph(*option);
    if (!verb.get_footer().empty()) out += ".PP\n.nf\n" + troff(verb.get_footer()) + "\n.fi\n";
    return out;
}

// -- completions

// The first sentence, without what shells or these scripts would take for their own.
std::string short_text(const std::string& text)
{
    std::string out = text.substr(0, text.find_first_of(".;:\n("));
    for (const char* mark : { "'", "[", "]", "`", "\"", "$", "\\" }) out = replaced(out, mark, "");
    while (!out.empty() && out.back() == ' ') out.pop_back();
    return out;
}

std::string words_of(const std::vector<std::string>& words) { return fmt::format("{}", fmt::join(words, " ")); }

std::vector<const CLI::Option*> long_options(const CLI::App& verb)
{
    return verb.get_options([](const CLI::Option* option) { return !option->get_lnames().empty(); });
}

// Words behind an option; of `help` the verbs.
std::string bash_verb(const CLI::App& verb)
{
    std::vector<std::string> names;
    std::string choices;
    for (const CLI::Option* option : long_options(verb)) {
        const std::string name = "--" + option->get_lnames()[0];
        names.push_back(name);
        const OptionValue value = shown_value(*option);
        if (!value.choices.empty())
            choices += fmt::format("                {}) COMPREPLY=($(compgen -W '{}' -- \"$word\")); return ;;\n", name,
                                   words_of(value.choices));
    }
    std::string out = fmt::format("        {})\n            options='{}'\n", verb.get_name(), words_of(names));
    if (!choices.empty()) out += "            case $before in\n" + choices + "            esac\n";
    return out + "            ;;\n";
}

std::string bash_completion(const CLI::App& app)
{
    std::string verbs;
    for (const CLI::App* verb : app.get_subcommands({})) verbs += bash_verb(*verb);
    return fmt::format(R"(# Completion of `pliant` for bash: pliant help --completion bash
_pliant() {{
    local word=${{COMP_WORDS[COMP_CWORD]}} before=${{COMP_WORDS[COMP_CWORD-1]}} verbs='{}' options=
    if ((COMP_CWORD == 1)) || [[ ${{COMP_WORDS[1]}} == help && $word != -* ]]; then
        COMPREPLY=($(compgen -W "$verbs" -- "$word"))
        return
    fi
    case ${{COMP_WORDS[1]}} in
{}    esac
    COMPREPLY=() # files, by -o default
    if [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "$options" -- "$word"))
    fi
}}
complete -o default -F _pliant pliant
)",
                       words_of(verb_names(app)), verbs);
}

std::string zsh_option(const CLI::Option& option)
{
    const OptionValue value = shown_value(option);
    std::string out = fmt::format("            '--{}[{}]", option.get_lnames()[0], short_text(option.get_description()));
    if (!value.choices.empty())
        out += fmt::format(":word:({})", words_of(value.choices));
    else if (!value.type.empty())
        out += ":value:_files";
    return out + "' \\\n";
}

std::string zsh_completion(const CLI::App& app)
{
    std::string verbs, options;
    for (const CLI::App* verb : app.get_subcommands({})) {
        verbs += fmt::format("        '{}:{}'\n", verb->get_name(), short_text(verb->get_description()));
        options += fmt::format("        {}) _arguments \\\n", verb->get_name());
        for (const CLI::Option* option : long_options(*verb)) options += zsh_option(*option);
        options += verb->get_name() == "help" ? "            '*:verb:_describe verb verbs' ;;\n"
                                              : "            '*:file:_files' ;;\n";
    }
    return fmt::format(R"(#compdef pliant
# Completion of `pliant` for zsh: pliant help --completion zsh
_pliant() {{
    local -a verbs=(
{}    )
    if ((CURRENT == 2)); then
        _describe verb verbs
        return
    fi
    local verb=$words[2]
    shift words
    ((CURRENT--))
    case $verb in
{}    esac
}}
_pliant "$@"
)",
                       verbs, options);
}

std::string fish_option(const std::string& verb, const CLI::Option& option)
{
    const OptionValue value = shown_value(option);
    std::string out = fmt::format("complete -c pliant -n '__fish_seen_subcommand_from {}' -l {} -d '{}'", verb,
                                  option.get_lnames()[0], short_text(option.get_description()));
    if (!option.get_snames().empty()) out += " -s " + option.get_snames()[0];
    if (!value.choices.empty())
        out += fmt::format(" -x -a '{}'", words_of(value.choices));
    else if (!value.type.empty())
        out += " -r";
    return out + "\n";
}

std::string fish_completion(const CLI::App& app)
{
    std::string out = "# Completion of `pliant` for fish: pliant help --completion fish\n";
    for (const CLI::App* verb : app.get_subcommands({})) {
        out += fmt::format("complete -c pliant -f -n __fish_use_subcommand -a {} -d '{}'\n", verb->get_name(),
                           short_text(verb->get_description()));
        for (const CLI::Option* option : long_options(*verb)) out += fish_option(verb->get_name(), *option);
    }
    return out
        + fmt::format("complete -c pliant -f -n '__fish_seen_subcommand_from help' -a '{}'\n", words_of(verb_names(app)));
}

} // namespace

std::string manual_page(const CLI::App& app)
{
    std::string out = fmt::format(".TH PLIANT 1 \"\" \"pliant {}\" \"User Commands\"\n.SH NAME\npliant \\- bake poses of a "
                                  "character and blend them elastically\n.SH SYNOPSIS\n.B pliant\n\\fIVERB\\fR "
                                  "[\\fIOPTIONS\\fR] [\\fIFILES\\fR]\n.SH DESCRIPTION\n{}\n.SH VERBS\n",
                                  version, troff(app.get_description()));
    for (const CLI::App* verb : app.get_subcommands({})) out += verb_section(*verb);
    return out + ".SH EXIT STATUS\n.nf\n" + troff(app.get_footer()) + "\n.fi\n";
}

std::string completion(const CLI::App& app, const std::string& shell)
{
    if (shell == "zsh") return zsh_completion(app);
    return shell == "fish" ? fish_completion(app) : bash_completion(app);
}

} // namespace pliant
