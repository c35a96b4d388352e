// pliant-player: plays an asset. See samples/player/README.md, or --help.
#include "blend/error.h"
#include "run/app.h"
#include "run/benchmark.h"
#include "run/options.h"
#include "run/pictures.h"
#include "run/sheet.h"

#include <csignal>
#include <cstdio>
#include <exception>
#include <string>
#include <utility>

namespace {

using namespace pliant::player;

int run(int argc, char** argv)
{
    const auto [options, exit_code] = parse_command_line(argc, argv);
    if (exit_code) return *exit_code;
    AssetFile file(options.asset);
    weights_for(options, file); // reports wrong weights before a missing driver
    if (!options.screenshot.empty()) {
        write_screenshot(options, file);
    } else if (!options.sequence.empty()) {
        write_sequence(options, file);
    } else if (!options.sheet.empty()) {
        write_sheet(options, file);
    } else if (options.benchmark_frames > 0) {
        run_benchmark(options, file);
    } else {
        run_window(options, std::move(file));
    }
    return static_cast<int>(ExitCode::done);
}

void flush_output()
{
    if (std::fflush(stdout) == 0 && !std::ferror(stdout)) return;
    throw Error(ErrorNumber::stdout_not_written, ExitCode::failed, "standard output could not be written",
                "free space on the disk that it goes to");
}

// Names come from files: bytes that would steer the terminal are written as numbers.
std::string printable(const std::string& text)
{
    std::string out;
    for (const char byte : text) {
        const auto code = static_cast<unsigned char>(byte);
        char number[5];
        std::snprintf(number, sizeof number, "\\x%02x", code);
        if (code < ' ' || code == 0x7f)
            out += number;
        else
            out += byte;
    }
    return out;
}

} // namespace

int main(int argc, char** argv)
{
#ifdef SIGXFSZ
    std::signal(SIGXFSZ, SIG_IGN); // a limit of file sizes is then an error of writing, which we report
#endif
    try {
        const int code = run(argc, argv);
        flush_output();
        return code;
    } catch (const Error& error) {
        std::fprintf(stderr, "pliant-player: error P%d: %s\n", static_cast<int>(error.number),
                     printable(error.what()).c_str());
        if (!error.hint.empty()) std::fprintf(stderr, "hint: %s\n", printable(error.hint).c_str());
        return static_cast<int>(error.exit_code);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "pliant-player: error P5903: %s\n", error.what());
        std::fprintf(stderr, "hint: the machine is probably out of memory; a smaller --size may help\n");
        return static_cast<int>(ExitCode::failed);
    }
}
