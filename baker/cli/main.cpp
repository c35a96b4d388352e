// The `pliant` tool: one program, one verb per task.
#include "cli/help_format.h"
#include "cli/out_of_memory.h"
#include "cli/usage_error.h"
#include "cli/verbs.h"

#include "base/common/version.h"

#include <cstdio>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <new>
#include <system_error>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

using namespace pliant;

// Also where there is none for a thread.
bool is_out_of_memory(const std::exception& e)
{
    const auto* const system = dynamic_cast<const std::system_error*>(&e);
    return dynamic_cast<const std::bad_alloc*>(&e)
        || (system
            && (system->code() == std::errc::not_enough_memory
                || system->code() == std::errc::resource_unavailable_try_again));
}

// Turns everything that can go wrong in `work` into messages and an exit code. `name` is that of the verb, once it is known.
ExitCode guarded(const std::string& name, const Verb& work)
{
    try {
        return work();
    } catch (const Failure& failure) {
        for (const Diagnostic& diagnostic : failure.diagnostics()) print_finding(name, diagnostic);
        return failure.code();
    } catch (const Interrupted&) {
        return ExitCode::interrupted;
    } catch (const std::exception& e) {
        if (is_out_of_memory(e))
            print_out_of_memory();
        else
            print_finding(
                name,
                error_at(4902, "", fmt::format("unexpected: {}", e.what()), "please report this with the command line"));
    }
    return ExitCode::failed;
}

// Vectors of a whole mesh come and go all the time. By default glibc hands each back to the system and has it zeroed anew.
void keep_freed_memory()
{
#ifdef __GLIBC__
    mallopt(M_MMAP_THRESHOLD, 1 << 30);
    mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

std::map<std::string, Verb> add_verbs(CLI::App& app)
{
    app.formatter(std::make_shared<HelpFormat>());
    app.set_version_flag("--version", baker_version);
    app.require_subcommand(1);
    app.footer("Exit codes: 0 success, 1 failure, 2 wrong usage, 3 bad input file, 4 tolerance missed, 130 "
               "interrupted.\n"
               "`pliant help VERB` explains a verb, with an example.");
    std::map<std::string, Verb> verbs;
    for (const auto& [name, add] : std::initializer_list<std::pair<const char*, Verb (*)(CLI::App&)>> {
             { "bake", add_bake },
             { "check", add_check },
             { "average", add_average },
             { "blend", add_blend },
             { "measure", add_measure },
             { "info", add_info },
             { "validate", add_validate },
             { "export", add_export },
             { "bake-all", add_bake_all },
             { "report", add_report },
             { "pose", add_pose },
             { "help", add_help },
         })
        verbs[name] = add(app);
    group_options(app);
    return verbs;
}

// `verb`: set to the name of the verb as soon as it is known.
ExitCode run_tool(int argc, char** argv, std::string& verb)
{
    keep_freed_memory();
    install_signal_handlers();
    CLI::App app("Pliant: bakes poses of a character into an asset that games blend elastically.", "pliant");
    const std::map<std::string, Verb> verbs = add_verbs(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return ExitCode(app.exit(e)); // --help, --version
        if (argc < 2) {
            std::fputs(app.help().c_str(), stderr);
            return ExitCode::usage;
        }
        const CLI::App* const chosen = chosen_verb(app);
        verb = chosen ? chosen->get_name() : "";
        throw Failure(ExitCode::usage, usage_error(app, e));
    }
    verb = chosen_verb(app)->get_name();
    name_interrupts(verb);
    return verbs.at(verb)();
}

} // namespace

int main(int argc, char** argv)
{
    open_closed_streams();
    start_with_fixed_blas(argv);
    const ExitWatch watch;
    std::string verb;
    const ExitCode code = guarded(verb, [&] { return run_tool(argc, argv, verb); });
    if (flush_output()) return int(code);
    print_finding(verb, error_at(4903, "", "standard output could not be written"));
    return int(code == ExitCode::interrupted ? code : ExitCode::failed);
}
