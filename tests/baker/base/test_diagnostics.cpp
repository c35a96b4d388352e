// Diagnostics: their text, and that thousands of them do not flood.
#include <doctest/doctest.h>

#include "base/common/diagnostics.h"
#include "base/common/progress.h"

using namespace pliant;

TEST_CASE("text of a finding")
{
    CHECK(to_text(error_at(2103, "run_04.obj:812", "face 377 uses vertex 9001, the file has 6890", "export it again"))
          == "error P2103: run_04.obj:812: face 377 uses vertex 9001, the file has 6890\n  hint: export it again");
    CHECK(to_text(warning_at(3010, "", "something")) == "warning P3010: something");
    const Failure failure(ExitCode::failed, { error_at(4001, "a", "b"), error_at(4002, "c", "d") });
    CHECK(std::string(failure.what()) == "error P4001: a: b\nerror P4002: c: d");
}

TEST_CASE("at most ten lines of a kind, then the number of the others and where they are")
{
    DiagnosticList list;
    for (int i = 0; i < 1000; ++i) {
        const std::string file = i < 500 ? "a.obj" : "c:b.obj";
        list.add(error_at(2103, file + ":" + std::to_string(i), "face", "hint"));
        if (i % 300 == 0) list.add(warning_at(2206, "a.obj", "vertex", "other hint"));
    }
    CHECK(list.error_count() == 1000);
    const std::vector<Diagnostic> diagnostics = list.diagnostics();
    REQUIRE(diagnostics.size() == 11 + 4);
    std::size_t lines = 0, hints = 0;
    for (const Diagnostic& diagnostic : diagnostics) {
        lines += diagnostic.number == 2103;
        hints += !diagnostic.hint.empty();
    }
    CHECK(lines == 11);
    CHECK(hints == 2); // once a kind, behind its last line
    bool has_overflow = false;
    for (const Diagnostic& diagnostic : diagnostics)
        has_overflow |= diagnostic.what == "... and 990 more in a.obj, c:b.obj" && diagnostic.hint == "hint";
    CHECK(has_overflow);
}

TEST_CASE("warnings alone are no errors; different advice is all given")
{
    DiagnosticList list(2);
    list.add(warning_at(2206, "a", "one", "x"));
    list.add(warning_at(2206, "a", "two", "y"));
    CHECK(!list.has_errors());
    REQUIRE(list.diagnostics().size() == 2);
    CHECK(list.diagnostics()[0].hint == "x");
    CHECK(list.diagnostics()[1].hint == "y");
}

TEST_CASE("one bar for work of several stages never goes back")
{
    struct Recorder : Progress {
        std::vector<double> fractions;
        void update(const std::string&, double fraction, const std::string&) override { fractions.push_back(fraction); }
    } recorder;
    PlannedProgress progress(recorder, { { "first", 0.2 }, { "rounds", 0.8, true }, { "last", 1 } });
    progress.update("first", 0.5);
    progress.update("first", 0.25); // a stage without rounds waits for what it had
    progress.update("unplanned", 0.9);
    progress.update("rounds", 0);
    progress.update("rounds", 1);
    progress.update("rounds", 0.5); // still the first round
    progress.update("rounds", 0);
    progress.update("rounds", 0.5); // the second round, up to its middle
    progress.update("unplanned", 0);
    progress.update("rounds", 1); // the third
    progress.update("first", 1);
    progress.update("last", 2);
    const std::vector<double> wanted = { 0.1, 0.1, 0.1, 0.2, 0.41, 0.41, 0.41, 0.47825, 0.47825, 0.5908625, 0.5908625, 1 };
    REQUIRE(recorder.fractions.size() == wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) CHECK(recorder.fractions[i] == doctest::Approx(wanted[i]));
}

TEST_CASE("the silent progress")
{
    Progress progress;
    progress.update("stage", 0.5);
    progress.warn(1, "nothing");
}

TEST_CASE("A message from a file of zeros stays short")
{
    const std::string text = to_text(error_at(2601, "weights.csv:1", std::string(10'000'000, '\0'), ""));
    CHECK(text.size() < 30'000);
    CHECK(text.find("(10000000 bytes)") != std::string::npos);
}

TEST_CASE("Names of strangers move no cursor")
{
    CHECK(printable("a\x1b[0m") == "a\\x1b[0m");
    CHECK(printable("a\xC2\x9B"
                    "31m")
          == "a\\xc2\\x9b31m");
    CHECK(printable("a\x9B"
                    "31m\xFF")
          == "a\\x9b31m\\xff");
    CHECK(printable("a\u202Eb\u2028\u2066") == "a\\xe2\\x80\\xaeb\\xe2\\x80\\xa8\\xe2\\x81\\xa6");
    CHECK(printable("Größe 身長 – \u00A0") == "Größe 身長 – \u00A0");
}
