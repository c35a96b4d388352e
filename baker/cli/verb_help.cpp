#include "cli/verbs.h"

#include "base/common/print.h"
#include "cli/manual.h"
#include "cli/usage_error.h"

#include <memory>

namespace pliant {

namespace {

struct HelpArguments {
    std::string verb, shell;
    bool is_manual = false;
};

// Not app.help(), which is that of the verb that was parsed: of this one.
std::string help_of(const CLI::App& app)
{
    return app.get_formatter()->make_help(&app, app.get_parent() ? "pliant " + app.get_name() : "pliant",
                                          CLI::AppFormatMode::Normal);
}

ExitCode run_help(const HelpArguments& a, const CLI::App& app)
{
    if (a.is_manual)
        print_to(stdout, "{}", manual_page(app));
    else if (!a.shell.empty())
        print_to(stdout, "{}", completion(app, a.shell));
    else
        print_to(stdout, "{}", help_of(a.verb.empty() ? app : find_verb(app, a.verb)));
    return ExitCode::done;
}

} // namespace

Verb add_help(CLI::App& app)
{
    auto a = std::make_shared<HelpArguments>();
    CLI::App* verb = app.add_subcommand("help", "Explain a verb; write the manual page or a shell's completion");
    verb->footer("Examples:\n  pliant help bake\n  source <(pliant help --completion bash)");
    CLI::Option* name = verb->add_option("verb", a->verb, "The verb; without it all of them are listed")->type_name("VERB");
    CLI::Option* manual = verb->add_flag("--man", a->is_manual, "Write the manual page (troff) to standard output");
    verb->add_option("--completion", a->shell, "Write a completion script to standard output")
        ->transform(CLI::IsMember({ "bash", "zsh", "fish" }, CLI::ignore_case))
        ->type_name("SHELL")
        ->excludes(name)
        ->excludes(manual);
    manual->excludes(name);
    return [a, &app] { return run_help(*a, app); };
}

} // namespace pliant
