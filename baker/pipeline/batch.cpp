#include "pipeline/batch.h"

#include "base/common/diagnostics.h"
#include "base/common/print.h"
#include "pipeline/child_process.h"
#include "pipeline/stamp.h"

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

namespace pliant {
namespace {

void print_line(const std::string& text) { print_to(stderr, "pliant bake-all: {}\n", text); }

// "pliant bake: error P2103: run.ply: ...", the first of them.
void note_error(BatchJob& job, const std::string& line, const std::string& prefix)
{
    if (job.error_number || line.rfind(prefix, 0) != 0 || line.size() < prefix.size() + 6) return;
    job.error_number = std::atoi(line.c_str() + prefix.size());
    job.error = line.substr(prefix.size() + 6);
}

// A line of a child under the name of its bake.
ChildGroup::LineSink line_printer(std::vector<BatchJob>& jobs)
{
    return [&jobs](std::size_t id, const std::string& line) {
        const std::string prefix = "pliant bake: ";
        note_error(jobs[id], line, prefix + "error P");
        print_line(jobs[id].name + ": " + (line.rfind(prefix, 0) == 0 ? line.substr(prefix.size()) : line));
    };
}

std::string missing_extra(const BatchJob& job)
{
    std::error_code error;
    for (const std::string& path : job.extras)
        if (!std::filesystem::exists(path, error)) return std::filesystem::path(path).filename().string() + " is missing";
    return {};
}

void check_job(BatchJob& job, bool is_forced)
{
    const StampVerdict verdict = check_stamp(job.options, job.output);
    job.reason = !verdict.reason.empty() ? verdict.reason : missing_extra(job);
    if (job.reason.empty() && is_forced) job.reason = "forced";
    if (!job.reason.empty()) return;
    job.exit_code = verdict.exit_code;
    job.outcome = verdict.exit_code == int(ExitCode::misses_tolerance) ? Outcome::misses_tolerance : Outcome::up_to_date;
}

// A failure that nobody has explained: the program could not be started in the child (127), or its messages were lost.
void record_failure(BatchJob& job, const ChildEnd& end)
{
    job.outcome = Outcome::failed;
    if (end.has_error) return;
    print_line(
        to_text(error_at(4605, job.name, fmt::format("the bake ended with exit code {} and said nothing", end.exit_code),
                         "lower --jobs, or close other programs")));
}

// Everything in a child's standard output that is not what it should be counts as a failure of the child: nothing is known
// then.
void take_estimate(BatchJob& job, const ChildEnd& end, double memory)
{
    const Json json = Json::parse(end.output, nullptr, false);
    if (!json.is_object() || !json.contains("estimate")) return record_failure(job, end);
    const Json& estimate = json["estimate"];
    job.estimated_dimension = estimate.value("dimension", 0L);
    job.estimated_seconds = estimate.value("seconds", 0.0);
    job.estimated_memory = estimate.value("memory", 0.0);
    if (job.estimated_memory <= memory) return;
    job.outcome = Outcome::too_large;
    print_line(to_text(
        error_at(4603, job.name,
                 fmt::format("needs {}, all bakes together may use {}", size_text(job.estimated_memory), size_text(memory)),
                 "raise --memory, lower --threads, or bake a coarser mesh")));
}

// A child that is asked to stop ends with an exit code, or by the signal if it has not installed its handlers yet.
bool is_interruption(const ChildEnd& end)
{
    const bool is_asked = end.signal == SIGINT || end.signal == SIGTERM || end.signal == SIGHUP;
    return is_asked || end.exit_code == int(ExitCode::interrupted);
}

// How a child ended, unless it was well.
void record_end(BatchJob& job, const ChildEnd& end)
{
    job.exit_code = end.exit_code;
    job.signal = end.signal;
    if (is_interruption(end)) {
        job.outcome = Outcome::interrupted;
    } else if (end.signal != 0) {
        job.outcome = Outcome::crashed;
        print_line(to_text(error_at(4602, job.name, fmt::format("the bake was killed by signal {}", end.signal),
                                    end.signal == 9
                                        ? "the system kills processes that use too much memory: lower --jobs or --memory"
                                        : "please report this with its poses")));
    } else if (end.exit_code == int(ExitCode::misses_tolerance)) {
        job.outcome = Outcome::misses_tolerance;
    } else if (end.exit_code != 0) {
        record_failure(job, end);
    }
}

bool is_bad(Outcome outcome)
{
    return outcome == Outcome::failed || outcome == Outcome::crashed || outcome == Outcome::too_large;
}

std::vector<std::string> talk_of(const BatchOptions& options)
{
    if (options.is_quiet) return { "--quiet" };
    if (options.is_verbose) return { "--verbose" };
    return {};
}

std::vector<std::string> arguments_of(const BatchJob& job, const std::vector<std::string>& flags)
{
    std::vector<std::string> arguments = { "bake" };
    arguments.insert(arguments.end(), flags.begin(), flags.end());
    arguments.insert(arguments.end(), job.arguments.begin(), job.arguments.end());
    return arguments;
}

// After an interrupt what waits never starts.
void drop_pending(std::vector<BatchJob>& jobs)
{
    for (BatchJob& job : jobs)
        if (job.outcome == Outcome::pending) job.outcome = Outcome::not_started;
}

// Which bakes run, and what they take together.
class Schedule {
public:
    Schedule(std::vector<BatchJob>& jobs, const BatchOptions& options)
        : jobs_(jobs)
        , options_(options)
    {
        for (std::size_t i = 0; i < jobs.size(); ++i)
            if (jobs[i].outcome == Outcome::pending) waiting_.push_back(i);
        total_ = waiting_.size();
    }

    std::size_t total() const { return total_; }
    std::size_t done() const { return done_; }

    // The next that may start now; its memory is taken. -1: none.
    std::ptrdiff_t next(std::size_t running)
    {
        if (running >= options_.job_count) return -1;
        for (auto i = waiting_.begin(); i != waiting_.end(); ++i) {
            const std::size_t id = *i;
            if (taken_ + jobs_[id].estimated_memory > options_.memory) continue;
            taken_ += jobs_[id].estimated_memory;
            waiting_.erase(i);
            return std::ptrdiff_t(id);
        }
        return -1;
    }

    void end(std::size_t id)
    {
        taken_ -= jobs_[id].estimated_memory;
        ++done_;
    }

    void drop_waiting()
    {
        for (const std::size_t id : waiting_) jobs_[id].outcome = Outcome::not_started;
        waiting_.clear();
    }

private:
    std::vector<BatchJob>& jobs_;
    const BatchOptions& options_;
    std::vector<std::size_t> waiting_;
    double taken_ = 0;
    std::size_t total_ = 0, done_ = 0;
};

void start_what_fits(std::vector<BatchJob>& jobs, const BatchOptions& options, Schedule& schedule, ChildGroup& children)
{
    for (std::ptrdiff_t id; (id = schedule.next(children.running_count())) >= 0;) {
        const BatchJob& job = jobs[std::size_t(id)];
        if (!options.is_quiet)
            print_line(fmt::format("{}: started; estimate: {} of memory, {:.0f} s", job.name,
                                   size_text(job.estimated_memory), job.estimated_seconds));
        children.start(std::size_t(id), arguments_of(job, talk_of(options)));
    }
}

void take_end(BatchJob& job, const ChildEnd& end, const Schedule& schedule, bool is_quiet)
{
    job.seconds = end.seconds;
    job.peak_memory = end.peak_memory;
    record_end(job, end);
    if (job.outcome == Outcome::pending) job.outcome = Outcome::baked;
    if (!is_quiet)
        print_line(fmt::format("[{}/{}] {}: {} in {:.1f} s", schedule.done(), schedule.total(), job.name,
                               name_of(job.outcome), job.seconds));
}

} // namespace

void judge_stamps(std::vector<BatchJob>& jobs, bool is_forced)
{
    for (BatchJob& job : jobs) check_job(job, is_forced);
}

bool plan_batch(std::vector<BatchJob>& jobs, const BatchOptions& options)
{
    ChildGroup children(options.wake, line_printer(jobs));
    std::size_t next = 0;
    for (;;) {
        for (; next < jobs.size() && children.running_count() < options.job_count; ++next)
            if (jobs[next].outcome == Outcome::pending)
                children.start(next, arguments_of(jobs[next], { "--dry-run", "--quiet" }));
        if (children.running_count() == 0) return true;
        const std::vector<ChildEnd> ended = children.wait();
        if (ended.empty()) {
            children.stop();
            drop_pending(jobs);
            return false;
        }
        for (const ChildEnd& end : ended) {
            record_end(jobs[end.id], end);
            if (jobs[end.id].outcome == Outcome::pending) take_estimate(jobs[end.id], end, options.memory);
        }
    }
}

bool run_batch(std::vector<BatchJob>& jobs, const BatchOptions& options)
{
    ChildGroup children(options.wake, line_printer(jobs));
    Schedule schedule(jobs, options);
    const auto stop_at_failure = [&] {
        const bool has_failed
            = std::any_of(jobs.begin(), jobs.end(), [](const BatchJob& job) { return is_bad(job.outcome); });
        if (options.is_fail_fast && has_failed) schedule.drop_waiting();
    };
    stop_at_failure();
    for (;;) {
        start_what_fits(jobs, options, schedule, children);
        if (children.running_count() == 0) return true;
        const std::vector<ChildEnd> ended = children.wait();
        if (ended.empty()) {
            schedule.drop_waiting();
            for (const ChildEnd& end : children.stop()) take_end(jobs[end.id], end, schedule, options.is_quiet);
            return false;
        }
        for (const ChildEnd& end : ended) {
            schedule.end(end.id);
            take_end(jobs[end.id], end, schedule, options.is_quiet);
        }
        stop_at_failure();
    }
}

} // namespace pliant
