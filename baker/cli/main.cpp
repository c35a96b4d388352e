// The `pliant` tool: one program, one verb per task.
#include "cli/help_format.h"
#include "cli/usage_error.h"
#include "cli/verbs.h"

#include "base/common/version.h"

#include <cstdio>
#include <fmt/core.h>
#include <new>
#ifdef __GLIBC__
#include <malloc.h>
#endif

namespace {

using namespace pliant;

// Runs the chosen verb and turns everything that can go wrong into messages and an exit code.
ExitCode guarded(const std::string& name, const Verb& verb)
{
    try {
        return verb();
    } catch (const Failure& failure) {
        for (const Diagnostic& diagnostic : failure.diagnostics()) print_finding(name, diagnostic);
        return failure.code();
    } catch (const Interrupted&) {
        return ExitCode::interrupted;
    } catch (const std::bad_alloc&) {
        print_finding(name, error_at(4901, "", "memory ran out", "`pliant check` estimates the memory of a bake"));
    } catch (const std::exception& e) {
        print_finding(
            name, error_at(4902, "", fmt::format("unexpected: {}", e.what()), "please report this with the command line"));
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

} // namespace

int main(int argc, char** argv)
{
    start_with_fixed_blas(argv);
    keep_freed_memory();
    install_signal_handlers();
    CLI::App app("Pliant: bakes poses of a character into an asset that games blend elastically.", "pliant");
    app.formatter(std::make_shared<HelpFormat>());
    app.set_version_flag("--version", baker_version);
    app.require_subcommand(1);
    app.footer("Exit codes: 0 success, 1 failure, 2 wrong usage, 3 bad input file, 4 tolerance missed, 130 "
               "interrupted.\n"
               "`pliant help VERB` explains a verb, with an example.");
    const std::vector<std::pair<std::string, Verb>> verbs = {
        { "bake", add_bake(app) },         { "check", add_check(app) },     { "average", add_average(app) },
        { "blend", add_blend(app) },       { "measure", add_measure(app) }, { "info", add_info(app) },
        { "validate", add_validate(app) }, { "export", add_export(app) },   { "bake-all", add_bake_all(app) },
        { "report", add_report(app) },     { "pose", add_pose(app) },       { "help", add_help(app) },
    };
    group_options(app);
    try {
        app.parse(argc, argv);
    } catch (const CLI::ParseError& e) {
        if (e.get_exit_code() == 0) return app.exit(e); // --help, --version
        const CLI::App* const verb = chosen_verb(app);
        if (argc < 2)
            std::fputs(app.help().c_str(), stderr);
        else
            print_finding(verb ? verb->get_name() : "", usage_error(app, e));
        return int(pliant::ExitCode::usage);
    }
    for (const auto& [name, verb] : verbs) {
        if (!app.got_subcommand(name)) continue;
        const ExitCode code = guarded(name, verb);
        if (std::fflush(stdout) != 0 || std::ferror(stdout)) {
            print_finding(name, error_at(4903, "", "standard output could not be written"));
            return int(ExitCode::failed);
        }
        return int(code);
    }
    return int(ExitCode::usage);
}
