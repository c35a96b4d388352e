// Where memory runs out the tool ends at once, with P4901 and exit code 1. Nothing is unwound: exceptions would cross
// functions that promise not to throw (CLI11, std::filesystem), and Eigen frees a matrix twice whose resizing throws. No
// memory is asked for while a temporary file is there, so none is left.
#pragma once

namespace pliant {

// P4901, without asking for memory.
void print_out_of_memory();

// Libraries that end the process for want of memory do so in words of their own (libgomp, below CHOLMOD): while this lives,
// a call of exit() says P4901, too.
class ExitWatch {
public:
    ExitWatch();
    ~ExitWatch();
    ExitWatch(const ExitWatch&) = delete;
    ExitWatch& operator=(const ExitWatch&) = delete;
};

} // namespace pliant
