// What the C++ of samples/site/pages/engines/unreal.md uses of Unreal, as little of it as compiles, and a program that
// prints the vertices and normals of a blend: recipe ASSET WEIGHT...
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <vector>

using uint8 = std::uint8_t;
using uint32 = std::uint32_t;
using uint64 = std::uint64_t;

struct FVector {
    double X = 0, Y = 0, Z = 0;
    FVector() = default;
    FVector(double x, double y, double z)
        : X(x)
        , Y(y)
        , Z(z)
    {
    }
};

template <class T> struct TArray {
    std::vector<T> values;
    void SetNumZeroed(std::size_t count) { values.assign(count, T()); }
    T* GetData() { return values.data(); }
    std::size_t Num() const { return values.size(); }
    T& operator[](std::size_t i) { return values[i]; }
};

#include "Recipe.h"

int main(int argc, char** argv)
{
    std::ifstream file(argv[1], std::ios::binary);
    std::vector<char> blob((std::istreambuf_iterator<char>(file)), {});
    std::vector<float> weights;
    for (int i = 2; i < argc; ++i) weights.push_back(std::strtof(argv[i], nullptr));
    FPliantCharacter character;
    if (!character.Open(blob.data(), blob.size()) || !character.Blend(weights.data())) return 1;
    for (std::size_t i = 0; i < character.Vertices.Num(); ++i) {
        const FVector &v = character.Vertices[i], &n = character.Normals[i];
        std::printf("%.9g %.9g %.9g %.9g %.9g %.9g\n", v.X, v.Y, v.Z, n.X, n.Y, n.Z);
    }
    return 0;
}
