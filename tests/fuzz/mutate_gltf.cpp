// Mutates binary glTF by its parts: the JSON as a text, the binary part as bytes, and states the right lengths again. Other
// bytes, .gltf for one, are mutated as texts.
#include "mutate_text.h"

#include <cstring>

namespace {

constexpr std::size_t header_size = 20, binary_header_size = 8;

std::uint32_t word_at(const std::uint8_t* data, std::size_t at)
{
    std::uint32_t word = 0;
    std::memcpy(&word, data + at, sizeof word);
    return word;
}

void append_word(std::string& bytes, std::size_t word)
{
    const std::uint32_t value = static_cast<std::uint32_t>(word);
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

std::string container_of(std::string json, const std::string& binary)
{
    json.append((4 - json.size() % 4) % 4, ' ');
    std::string bytes = "glTF";
    append_word(bytes, 2);
    append_word(bytes, header_size + json.size() + binary_header_size + binary.size());
    append_word(bytes, json.size());
    bytes += "JSON" + json;
    append_word(bytes, binary.size());
    return bytes.append("BIN\0", 4) + binary;
}

// libFuzzer's own mutations, of a part alone.
void mutate_bytes(std::string& part, std::size_t max_size)
{
    const std::size_t size = part.size();
    part.resize(max_size);
    part.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(part.data()), size, max_size));
}

} // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size, unsigned int seed)
{
    const std::size_t json_size = size >= header_size ? word_at(data, 12) : 0;
    const std::size_t rest = header_size + json_size;
    if (size < header_size || std::memcmp(data, "glTF", 4) != 0 || rest + binary_header_size > size)
        return mutate_text(data, size, max_size, seed);
    if (seed % 16 == 0) return LLVMFuzzerMutate(data, size, max_size);
    std::string json(data + header_size, data + rest), binary(data + rest + binary_header_size, data + size);
    const std::size_t room = max_size > size ? max_size - size : 0;
    if (seed % 16 < 4) {
        mutate_bytes(binary, binary.size() + room);
    } else {
        json.resize(json.size() + room);
        json.resize(mutate_text(reinterpret_cast<std::uint8_t*>(json.data()), json_size, json.size(), seed / 16));
    }
    const std::string made = container_of(std::move(json), binary);
    if (made.size() > max_size) return size;
    std::memcpy(data, made.data(), made.size());
    return made.size();
}
