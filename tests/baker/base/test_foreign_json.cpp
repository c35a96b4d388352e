// JSON of strangers: all of ours is read, and what would take quadratic time is not.
#include "base/common/foreign_json.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace pliant;

namespace {

// A list of objects.
std::string objects(int count, int key_count)
{
    std::string object, all;
    for (int k = 0; k < key_count; ++k) object += fmt::format("{}\"{}\":{{\"x\":[]}}", k ? "," : "", k);
    for (int i = 0; i < count; ++i) all += (i ? ",{" : "{") + object + "}";
    return "[" + all + "]";
}

} // namespace

TEST_CASE("the certificate of a large bake is read, an object of many keys is not")
{
    CHECK(parse_foreign_json(objects(4000, 10)).size() == 4000);
    CHECK(parse_foreign_json(objects(2, 1000)).size() == 2);
    CHECK(parse_foreign_json(objects(2, 1001)).is_discarded());
    CHECK(parse_foreign_json("{").is_discarded());
}

TEST_CASE("a zero byte does not end the text")
{
    CHECK(parse_foreign_json("{}").is_object());
    CHECK(parse_foreign_json(std::string("{}\0", 3)).is_discarded());
    CHECK(parse_foreign_json(std::string("{}\0}", 4)).is_discarded());
}

TEST_CASE("depth and keys are counted for any bytes")
{
    CHECK(json_shape("}]:{\"a\":{\"b\":1,\"c\":2},\"d\":[[3]]}").nesting == 1);
    CHECK(json_shape("{\"a\":{\"b\":1,\"c\":2},\"d\":3,\"e\":\"{:\\\":\"}").key_count == 3);
    CHECK(json_shape(std::string(1000, '[')).nesting == 1000);
    CHECK(json_shape(std::string(1000, '{') + std::string(1000, ':')).key_count == 1000);
}
