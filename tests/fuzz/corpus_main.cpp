// Runs a fuzz target over its corpus, and over mutations of it, without a fuzzing compiler: <program> FOLDER [mutations of each file].
// The same text comes out as a crash under the sanitizers. Mutations are the same on every run.
#include "base/noise.h"

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Input = std::vector<std::uint8_t>;

// Bytes changed, cut out, repeated or cut off, as real damage does it.
Input mutated(Input input, std::uint64_t seed) {
    std::uint64_t n = 0;
    const auto random = [&](std::uint64_t below) { return below ? entoptic::mix64(seed ^ entoptic::mix64(++n)) % below : 0; };
    for (std::uint64_t k = 0, count = 1 + random(4); k < count && !input.empty(); ++k) {
        const auto at = static_cast<std::ptrdiff_t>(random(input.size()));
        const auto length =
            static_cast<std::ptrdiff_t>(1 + random(std::min<std::uint64_t>(16, input.size() - static_cast<std::uint64_t>(at))));
        switch (random(5)) {
            case 0:
                input[static_cast<std::size_t>(at)] = static_cast<std::uint8_t>(random(256));
                break;
            case 1:
                input[static_cast<std::size_t>(at)] ^= static_cast<std::uint8_t>(1u << random(8));
                break;
            case 2:
                input.erase(input.begin() + at, input.begin() + std::min<std::ptrdiff_t>(at + length, std::ssize(input)));
                break;
            case 3: {
                const Input piece(input.begin() + at, input.begin() + std::min<std::ptrdiff_t>(at + length, std::ssize(input)));
                input.insert(input.begin() + at, piece.begin(), piece.end());
                break;
            }
            default:
                input.resize(static_cast<std::size_t>(at));
                break;
        }
    }
    return input;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2 || argc > 3) {
        std::fprintf(stderr, "usage: %s FOLDER [MUTATIONS]\n", argv[0]);
        return 2;
    }
    const std::uint64_t mutations = argc == 3 ? std::strtoull(argv[2], nullptr, 10) : 5000;
    std::uint64_t files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) {
        std::ifstream file(entry.path(), std::ios::binary);
        const Input input{std::istreambuf_iterator<char>(file), {}};
        ++files;
        LLVMFuzzerTestOneInput(input.data(), input.size());
        for (std::uint64_t i = 0; i < mutations; ++i) {
            const Input other = mutated(input, entoptic::mix64(files) + i);
            LLVMFuzzerTestOneInput(other.data(), other.size());
        }
    }
    std::printf("%llu inputs, %llu mutations of each\n", static_cast<unsigned long long>(files),
                static_cast<unsigned long long>(mutations));
    if (files == 0) {
        std::fprintf(stderr, "%s holds no corpus\n", argv[1]);
        return 1;
    }
    return 0;
}
