// An error that ends the player: a number for people and scripts, one line that says what failed, one line that helps.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace pliant::player {

// Exit codes of the process, the same as those of the `pliant` tool.
enum class ExitCode : int { done = 0, failed = 1, usage = 2, bad_input = 3 };

// README.md lists the numbers. A number never changes its meaning.
enum class ErrorNumber : int {
    usage = 5901,
    weights = 5902,
    file_unreadable = 5911,
    asset_refused = 5912,
    path_refused = 5913,
    truth_mesh_refused = 5914,
    truth_of_another = 5915,
    no_context = 5921,
    gl_refused = 5922,
    rebuild_refused = 5923,
    picture_not_written = 5931,
    stdout_not_written = 5932,
    no_frame_number = 5941,
    modes_exclude = 5942
};

class Error : public std::runtime_error {
public:
    Error(ErrorNumber error_number, ExitCode code, const std::string& what, std::string hint_line)
        : std::runtime_error(what)
        , number(error_number)
        , exit_code(code)
        , hint(std::move(hint_line))
    {
    }

    ErrorNumber number;
    ExitCode exit_code;
    std::string hint;
};

} // namespace pliant::player
