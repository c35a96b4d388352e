// Files are written whole or not at all, and what can be known before long work is known before it.
#include <doctest/doctest.h>

#include "files.h"
#include "input/io/write_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <thread>

using namespace pliant;
using pliant_test::number_of;
using pliant_test::read_bytes;
using pliant_test::TemporaryFolder;
using pliant_test::write_bytes;

namespace {

// Both ways of diagnostic the same fault: before the work and while writing.
int number_writing(const std::string& path)
{
    const int while_writing = number_of([&] { write_file_atomically(path, "new"); });
    if (!path.empty()) CHECK(number_of([&] { probe_outputs({ path }, {}); }) == while_writing);
    return while_writing;
}

} // namespace

TEST_CASE("a file is created, then replaced, and nothing else appears")
{
    const TemporaryFolder folder;
    write_file_atomically(folder / "a.bin", std::string_view("one\0two", 7));
    CHECK(read_bytes(folder / "a.bin") == std::string("one\0two", 7));
    write_file_atomically(folder / "a.bin", "");
    CHECK(read_bytes(folder / "a.bin").empty());
    const std::string large(std::size_t(20) << 20, 'x');
    write_file_atomically(folder / "a.bin", large);
    CHECK(read_bytes(folder / "a.bin") == large);
    CHECK(folder.file_count() == 1);
}

TEST_CASE("names with spaces, dashes, letters of the world, and the longest there are")
{
    const TemporaryFolder folder;
    for (const std::string& name :
         { std::string("-o"), std::string("a b"), std::string("\xe6\xa8\xa1"), std::string(255, 'n'), std::string(".x") }) {
        write_file_atomically(folder / name, "content");
        CHECK(read_bytes(folder / name) == "content");
    }
    CHECK(folder.file_count() == 5);
}

TEST_CASE("a relative name without a folder")
{
    const TemporaryFolder folder;
    const auto before = std::filesystem::current_path();
    std::filesystem::current_path(folder.path());
    write_file_atomically("plain", "content");
    std::filesystem::current_path(before);
    CHECK(read_bytes(folder / "plain") == "content");
}

TEST_CASE("permissions stay, links are followed")
{
    const TemporaryFolder folder;
    write_bytes(folder / "a", "old");
    ::chmod((folder / "a").c_str(), 0640);
    std::filesystem::create_symlink("a", folder / "link");
    write_file_atomically(folder / "link", "new");
    CHECK(read_bytes(folder / "a") == "new");
    CHECK(std::filesystem::is_symlink(folder / "link"));
    struct stat status {};
    ::stat((folder / "a").c_str(), &status);
    CHECK((status.st_mode & 07777) == 0640);
    ::chmod((folder / "a").c_str(), 04750);
    write_file_atomically(folder / "a", "newer");
    REQUIRE(::stat((folder / "a").c_str(), &status) == 0);
    CHECK((status.st_mode & 07777) == 0750);
}

TEST_CASE("what cannot be written is refused, before and while writing")
{
    const TemporaryFolder folder;
    CHECK(number_writing(folder / "missing/a") == 4001);
    CHECK(number_writing(folder.path()) == 4003);
    CHECK(number_writing(folder.path() + "/") == 4003);
    CHECK(number_writing("") == 4003);
    CHECK(number_writing("/dev/full") == 4006);
    CHECK(number_writing("/proc/nothing") == 4002);
    std::filesystem::create_symlink("nowhere", folder / "dangling");
    CHECK(number_writing(folder / "dangling") == 4006);
    write_bytes(folder / "file", "old");
    CHECK(number_writing(folder / "file/a") == 4001);
    ::chmod((folder / "file").c_str(), 0444);
    CHECK(number_writing(folder / "file") == 4006);
    CHECK(read_bytes(folder / "file") == "old");
    CHECK(folder.file_count() == 2);
}

TEST_CASE("a folder that may not be written to")
{
    const TemporaryFolder folder;
    std::filesystem::create_directory(folder / "locked");
    write_bytes(folder / "locked/a", "old");
    ::chmod((folder / "locked").c_str(), 0555);
    ::chmod(folder.path().c_str(), 0755);
    // The superuser may write everywhere, so a child without those rights has to try.
    const pid_t child = ::fork();
    if (child == 0) {
        if (::geteuid() == 0 && ::setuid(65534) != 0) ::_exit(99);
        ::_exit(number_of([&] { write_file_atomically(folder / "locked/a", "new"); }) == 4002 ? 0 : 1);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    CHECK(WIFEXITED(status));
    CHECK(WEXITSTATUS(status) == 0);
    CHECK(read_bytes(folder / "locked/a") == "old");
    ::chmod((folder / "locked").c_str(), 0755);
}

TEST_CASE("an output that is an input, by whatever name")
{
    const TemporaryFolder folder;
    write_bytes(folder / "a", "old");
    std::filesystem::create_hard_link(folder / "a", folder / "b");
    std::filesystem::create_symlink("a", folder / "c");
    CHECK(number_of([&] { probe_outputs({ folder / "new" }, { folder / "a" }); }) == 0);
    for (const char* name : { "a", "./a", "b", "c" })
        CHECK(number_of([&] { probe_outputs({ folder / name }, { folder / "other", folder / "a" }); }) == 4004);
    CHECK(folder.file_count() == 3);
    CHECK(read_bytes(folder / "a") == "old");
}

TEST_CASE("two outputs that are one file")
{
    const TemporaryFolder folder;
    write_bytes(folder / "a", "old");
    std::filesystem::create_directory(folder / "sub");
    std::filesystem::create_symlink("a", folder / "c");
    std::filesystem::create_symlink("sub", folder / "other");
    CHECK(number_of([&] { probe_outputs({ folder / "new", folder / "newer", folder / "sub/new", "" }, {}); }) == 0);
    CHECK(number_of([&] { probe_outputs({ folder / "new", folder / "./new" }, {}); }) == 4004);
    CHECK(number_of([&] { probe_outputs({ folder / "a", folder / "b", folder / "c" }, {}); }) == 4004);
    CHECK(number_of([&] { probe_outputs({ folder / "sub/new", folder / "other/new" }, {}); }) == 4004);
    CHECK(folder.file_count() == 4);
}

TEST_CASE("temporaries that nobody holds are removed, those of writers and of other names are not")
{
    const TemporaryFolder folder;
    for (const char* name : { ".a.pliant-tmp-0123456789abcdef", ".a.pliant-tmp-4711", ".a.pliant-tmp-aa", ".b.pliant-tmp-aa",
                              ".a.pliant-tmp-x" })
        write_bytes(folder / name, "left over");
    // As of a writer in another container: its process id means nothing here, its lock does.
    const int held = ::open((folder / ".a.pliant-tmp-aa").c_str(), O_RDWR);
    REQUIRE(::flock(held, LOCK_EX | LOCK_NB) == 0);
    write_file_atomically(folder / "a", "new");
    CHECK(!std::filesystem::exists(folder / ".a.pliant-tmp-0123456789abcdef"));
    CHECK(!std::filesystem::exists(folder / ".a.pliant-tmp-4711"));
    CHECK(std::filesystem::exists(folder / ".a.pliant-tmp-aa"));
    CHECK(std::filesystem::exists(folder / ".b.pliant-tmp-aa"));
    CHECK(std::filesystem::exists(folder / ".a.pliant-tmp-x"));
    CHECK(folder.file_count() == 4);
    ::close(held);
}

TEST_CASE("threads that write one name: one of the whole files stays")
{
    const TemporaryFolder folder;
    std::vector<std::thread> threads;
    for (int i = 0; i < 8; ++i) {
        threads.emplace_back([&, i] {
            for (int k = 0; k < 20; ++k)
                write_file_atomically(folder / "a", std::string(1000 + 100 * std::size_t(i), char('a' + i)));
        });
    }
    for (std::thread& thread : threads) thread.join();
    const std::string content = read_bytes(folder / "a");
    CHECK(content == std::string(1000 + 100 * std::size_t(content[0] - 'a'), content[0]));
    CHECK(folder.file_count() == 1);
}
