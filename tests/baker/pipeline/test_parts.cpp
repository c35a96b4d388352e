// The pieces behind pipelines: digests, dependency files, nearest words, hand-written JSON, the log of what was read.
#include "base/common/sha256.h"
#include "input/io/read_log.h"
#include "input/io/source_file.h"
#include "pipeline/depfile.h"
#include "pipeline/json_file.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

using namespace pliant;

namespace {

// A folder that is gone at the end.
struct Folder {
    std::filesystem::path path;
    Folder()
    {
        std::string name = (std::filesystem::temp_directory_path() / "pliant-parts-XXXXXX").string();
        path = ::mkdtemp(name.data());
    }
    ~Folder() { std::filesystem::remove_all(path); }
    std::string write(const char* name, const std::string& text) const
    {
        std::ofstream(path / name) << text;
        return (path / name).string();
    }
};

int number_of(const std::string& path)
{
    try {
        read_json_file(path);
        return 0;
    } catch (const Failure& failure) {
        CHECK(failure.code() == ExitCode::bad_input);
        return failure.diagnostics().at(0).number;
    }
}

} // namespace

TEST_CASE("SHA-256 of the standard's examples and of all lengths around a block")
{
    CHECK(sha256_hex("") == "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
    CHECK(sha256_hex("abc") == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    CHECK(sha256_hex("abcdbcdecdefdefgefghfghighijhijkijkljklmklmnlmnomnopnopq")
          == "248d6a61d20638b8e5c026930c3e6039a33ce45964ff2167f6ecedd419db06c1");
    CHECK(sha256_hex(std::string(1000000, 'a')) == "cdc76e5c9914fb9281a1c7e284d73e67f1809a48a497200e046d39ccc7112cd0");
    // Python: hashlib.sha256("".join(hashlib.sha256(b"x" * n).hexdigest() for n in range(130)).encode()).hexdigest()
    std::string all;
    for (std::size_t n = 0; n < 130; ++n) all += sha256_hex(std::string(n, 'x'));
    CHECK(sha256_hex(all) == "199af942eba7fa5d1e16d475169eb24018b14e69339c93d26a9ea6d873b4ace6");
}

TEST_CASE("dependency files escape what Make and Ninja take for something else")
{
    CHECK(write_depfile("out.pliant", { "a.ply" }) == "out.pliant: \\\n  a.ply\n");
    CHECK(write_depfile("o", { "my pose.ply", "a#b.obj", "c$d.obj" })
          == "o: \\\n  my\\ pose.ply \\\n  a\\#b.obj \\\n  c$$d.obj\n");
    CHECK(write_depfile("o", { "a\\b", "a\\ b" }) == "o: \\\n  a\\b \\\n  a\\\\\\ b\n");
    CHECK(write_depfile("o", { "a/~-(1).ply" }) == "o: \\\n  a/~-(1).ply\n");
    for (const char* name : { "a\nb", "x;touch PWNED;.png", "a|b", "a\\", "!=touch PWNED", "a:=b", "a:b", "a%", "a*", "a?",
                              "[a]", "o&", "~root", "-lm", "x(1)", "a\x01" })
        CHECK_THROWS_AS(write_depfile("o", { name }), Failure); // P4604
}

TEST_CASE("the nearest word")
{
    const std::vector<std::string> words = { "tolerance", "tolerance_max", "dim", "seed", "no_align" };
    CHECK(nearest_word("tolerence", words) == "tolerance");
    CHECK(nearest_word("tolerance-max", words) == "tolerance_max");
    CHECK(nearest_word("Dim", words) == "dim");
    CHECK(nearest_word("sede", words) == "seed"); // two letters swapped
    CHECK(nearest_word("noalign", words) == "no_align");
    CHECK(nearest_word("banana", words).empty());
    CHECK(nearest_word(std::string(1000000, 'x'), words).empty());
    CHECK(nearest_word("tolerence", { std::string(5000000, 'e'), "tolerance" }) == "tolerance");
}

TEST_CASE("hand-written JSON: what is wrong is named")
{
    const Folder folder;
    CHECK(read_json_file(folder.write("good.json", "{\"a\": [1, {\"a\": 2}], \"b\": {\"a\": 3}}"))["a"][0] == 1);
    CHECK(number_of((folder.path / "missing.json").string()) == 2001);
    CHECK(number_of(folder.write("list.json", "[1]")) == 2701);
    CHECK(number_of(folder.write("cut.json", "{\"a\": 1,\n \"b\" 2}")) == 2701);
    CHECK(number_of(folder.write("empty.json", "")) == 2701);
    CHECK(number_of(folder.write("not_a_number.json", "{\"a\": nan}")) == 2701);
    CHECK(number_of(folder.write("infinite.json", "{\"a\": 1e999}")) == 2701);
    CHECK(number_of(folder.write("deep.json", "{\"a\":" + std::string(1000000, '[') + "}")) == 2702);
    CHECK(number_of(folder.write("twice.json", "{\"a\": {\"b\": 1, \"b\": 2}}")) == 2703);
    try {
        read_json_file((folder.path / "cut.json").string());
    } catch (const Failure& failure) {
        CHECK(std::string(failure.what()).find("line 2, column 6") != std::string::npos);
    }
}

TEST_CASE("a log notes every file once, and what could not be read")
{
    const Folder folder;
    const std::string a = folder.write("a", "abc"), missing = (folder.path / "missing").string();
    DiagnosticList diagnostics;
    const ReadLog outer;
    read_bytes(a, diagnostics);
    {
        const ReadLog inner;
        read_bytes(missing, diagnostics);
        read_bytes(missing, diagnostics);
        CHECK(inner.files().size() == 1);
        CHECK(inner.files()[0].digest.empty());
    }
    read_bytes(a, diagnostics);
    REQUIRE(outer.files().size() == 1);
    CHECK(outer.files()[0].path == a);
    CHECK(outer.files()[0].digest == sha256_hex("abc"));
}
