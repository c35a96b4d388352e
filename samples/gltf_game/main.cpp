// A game of one character: loads a GLB with tinygltf, finds the Pliant asset in it, and blends.
#include "elastic_model.h"
#include "window.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace {

constexpr char help[]
    = "gltf_game FILE.glb [--weights W,W,...] [--headless POSITIONS.f32 | --picture PICTURE.ppm]\n"
      "\n"
      "Shows a character that `pliant export ASSET --embed -o FILE.glb` wrote, going round its poses or layers. Escape ends "
      "it.\n"
      "\n"
      "  --weights W,W,...          one weight for each pose or layer, held still\n"
      "  --headless POSITIONS.f32   no window: write the positions of all vertices (x y z, little-endian floats)\n"
      "  --picture PICTURE.ppm      draw one picture and end\n"
      "\n"
      "Exit code: 0, 1 if something failed, 2 for a wrong argument.\n";

struct Options {
    std::string file, positions, picture;
    std::vector<float> weights;
};

struct Usage : std::runtime_error {
    using std::runtime_error::runtime_error;
};

std::vector<float> parse_weights(const char* text)
{
    std::vector<float> weights;
    for (char* end = nullptr;; text = end + 1) {
        weights.push_back(std::strtof(text, &end));
        if (end == text) throw Usage("--weights: not a list of numbers");
        if (*end == 0) return weights;
        if (*end != ',') throw Usage("--weights: not a list of numbers");
    }
}

Options parse(int argc, char** argv)
{
    Options options;
    for (int i = 1; i < argc; ++i) {
        const std::string word = argv[i];
        const auto value = [&] {
            if (++i == argc) throw Usage(word + " needs a value");
            return argv[i];
        };
        if (word == "--weights")
            options.weights = parse_weights(value());
        else if (word == "--headless")
            options.positions = value();
        else if (word == "--picture")
            options.picture = value();
        else if (word[0] == '-' || !options.file.empty())
            throw Usage("unknown argument " + word);
        else
            options.file = word;
    }
    if (options.file.empty()) throw Usage("no file is given");
    for (const std::string& output : { options.positions, options.picture }) {
        std::error_code missing;
        if (std::filesystem::equivalent(options.file, output, missing)) throw Usage(output + " is the file to show");
    }
    return options;
}

void write_positions(const game::ElasticModel& model, const std::string& path)
{
    std::ofstream file(path, std::ios::binary);
    for (const game::Vertex& vertex : model.vertices())
        file.write(reinterpret_cast<const char*>(vertex.position), sizeof vertex.position);
    if (!file.flush()) throw std::runtime_error(path + " cannot be written");
}

// One layer after the other to the high end of its range and back, two seconds each.
std::vector<float> layers_at(double seconds, const game::ElasticModel& model)
{
    const double at = seconds / 2, share = 0.5 - 0.5 * std::cos(2 * 3.14159265358979 * (at - std::floor(at)));
    std::vector<float> weights;
    for (std::uint32_t k = 0; k < model.weight_count(); ++k) {
        const pliant_weight weight = model.weight(k);
        const bool moves = std::size_t(at) % model.weight_count() == k;
        weights.push_back(weight.initial + (moves ? float(share) * (weight.high - weight.initial) : 0));
    }
    return weights;
}

// From pose to pose, two seconds each.
std::vector<float> weights_at(double seconds, const game::ElasticModel& model)
{
    if (model.has_layers()) return layers_at(seconds, model);
    const std::size_t pose_count = model.weight_count();
    const double at = seconds / 2, share = 0.5 - 0.5 * std::cos(3.14159265358979 * (at - std::floor(at)));
    std::vector<float> weights(pose_count, 0);
    weights[std::size_t(at) % pose_count] = float(1 - share);
    weights[(std::size_t(at) + 1) % pose_count] += float(share);
    return weights;
}

void play(game::ElasticModel& model, bool is_still)
{
    game::Window window(model, 1280, 800, true);
    for (long frame = 0; window.is_open(); ++frame) {
        if (!is_still) model.blend(weights_at(double(frame) / 60, model));
        window.draw();
        window.show();
    }
}

void run(const Options& options)
{
    game::ElasticModel model(options.file);
    if (!options.weights.empty()) model.blend(options.weights);
    if (!options.positions.empty()) {
        write_positions(model, options.positions);
    } else if (!options.picture.empty()) {
        game::Window window(model, 800, 600, false);
        window.draw();
        window.save(options.picture);
    } else {
        play(model, !options.weights.empty());
    }
}

} // namespace

int main(int argc, char** argv)
{
    if (argc == 2 && (!std::strcmp(argv[1], "--help") || !std::strcmp(argv[1], "-h"))) return std::fputs(help, stdout) < 0;
    try {
        run(parse(argc, argv));
        return 0;
    } catch (const Usage& error) {
        std::fprintf(stderr, "gltf_game: error: %s\n%s", error.what(), "hint: gltf_game --help\n");
        return 2;
    } catch (const std::out_of_range&) {
        std::fprintf(stderr, "gltf_game: error: a number in the file refers to nothing\n");
        return 1;
    } catch (const std::exception& error) {
        std::fprintf(stderr, "gltf_game: error: %s\n", error.what());
        return 1;
    }
}
