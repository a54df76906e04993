#include "samples/demo/materials.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <thread>

namespace samples {

namespace {

constexpr float pi = std::numbers::pi_v<float>;
const glm::vec3 ink(0.035F);         // black print reflects about 4 %
const glm::vec3 white_paper(0.80F);  // office paper

Canvas paint_plain() { return {1, 1, glm::vec3(1)}; }

// Boards along x with grain: stretched noise and rings, albedo about 0.3.
Canvas paint_wood() {
    Canvas canvas(1024, 512, glm::vec3(0));
    canvas.shade([](glm::vec2 p) {
        const float board = std::floor(p.y * 4.0F);
        const auto seed = static_cast<std::uint32_t>(board);
        const float bend = tiling_noise({p.x * 4.0F, p.y * 8.0F}, 8, 11 + seed);
        const float rings = 0.5F + 0.5F * std::sin(2 * pi * (p.y * 26.0F + bend * 2.2F + static_cast<float>(seed) * 0.37F));
        const float fibre = tiling_noise({p.x * 32.0F, p.y * 256.0F}, 256, 5);
        const float edge = std::abs(p.y * 4.0F - std::round(p.y * 4.0F)) < 0.006F ? 0.6F : 1.0F;
        const glm::vec3 colour = glm::mix(srgb(0x8A5A34), srgb(0xB98552), 0.25F + 0.45F * rings + 0.3F * fibre);
        return colour * edge * (0.92F + 0.12F * hash01(seed, 3));
    });
    return canvas;
}

Canvas paint_floor() {
    Canvas canvas(1024, 1024, glm::vec3(0));
    canvas.shade([](glm::vec2 p) {
        const float row = std::floor(p.y * 8.0F);
        const float shifted = p.x * 2.0F + hash01(static_cast<std::uint32_t>(row), 9) * 2.0F;
        const auto plank = static_cast<std::uint32_t>(row * 16.0F + std::floor(std::fmod(shifted, 2.0F)));
        const float grain = tiling_noise({p.x * 16.0F, p.y * 256.0F}, 256, 21);
        const float figure = tiling_noise({p.x * 8.0F, p.y * 64.0F}, 64, 22);
        const glm::vec2 to_edge{std::abs(shifted - std::round(shifted)) * 4.0F, std::abs(p.y * 8.0F - std::round(p.y * 8.0F))};
        const float joint = std::min(to_edge.x, to_edge.y) < 0.012F ? 0.45F : 1.0F;
        const glm::vec3 colour = glm::mix(srgb(0x6B4A30), srgb(0x94704C), 0.5F * grain + 0.5F * figure);
        return colour * joint * (0.8F + 0.35F * hash01(plank, 17));
    });
    return canvas;
}

Canvas paint_plaster() {
    Canvas canvas(256, 256, glm::vec3(0));
    canvas.shade([](glm::vec2 p) {
        const float coarse = tiling_noise(p * 16.0F, 16, 31), fine = tiling_noise(p * 96.0F, 96, 32);
        return glm::vec3(0.90F + 0.05F * coarse + 0.05F * fine);  // times the wall's tint
    });
    return canvas;
}

Canvas paint_fabric() {
    Canvas canvas(256, 256, glm::vec3(0));
    canvas.shade([](glm::vec2 p) {
        const float weave = 0.5F + 0.25F * std::sin(2 * pi * 48.0F * p.x) + 0.25F * std::sin(2 * pi * 48.0F * p.y);
        return glm::vec3(0.75F + 0.25F * weave * tiling_noise(p * 32.0F, 32, 41));
    });
    return canvas;
}

// Rows of optotypes, each 0.8 of the one above (a tenth of a logarithmic unit, as on an ETDRS chart). The chart hangs 2.4 m
// away and is 0.8 m high: its largest C is 0.16 m, 3.8°; the gap of row n is 46' * 0.8^n, 1' would be row 17.
Canvas paint_acuity_chart() {
    Canvas canvas(768, 1024, white_paper);
    canvas.rectangle({0.0F, 0.0F}, {1.0F, 0.004F}, ink);
    canvas.rectangle({0.0F, 0.996F}, {1.0F, 1.0F}, ink);
    constexpr std::array counts{2, 3, 4, 5, 5, 5, 6, 7, 8, 9, 9};
    float size = 0.185F, y = 0.03F;
    for (std::size_t row = 0; row < counts.size(); ++row) {
        const int count = counts[row];
        for (int i = 0; i < count; ++i) {
            const float x = 0.5F + (static_cast<float>(i) - 0.5F * static_cast<float>(count - 1)) *
                                       std::min(size * 2.0F / canvas.aspect() * 0.9F, 0.9F / static_cast<float>(count));
            const int quarter = static_cast<int>(hash01(static_cast<std::uint32_t>(row), static_cast<std::uint32_t>(i), 77) * 4.0F);
            const glm::vec2 centre{x, y + 0.5F * size};
            if (row % 2 == 0) {
                canvas.landolt_c(centre, size, quarter, ink);
            } else {
                canvas.snellen_e(centre, size, quarter, ink);
            }
        }
        y += size + std::max(0.022F, size * 0.22F);
        size *= 0.8F;
    }
    return canvas;
}

// Eighteen colours and six greys after the usual photographic chart (approximate sRGB), over a fan of pure hues at three
// lightnesses and a red-on-green pair that swaps its lightness in the dark (Purkinje).
Canvas paint_colour_poster() {
    constexpr std::array<std::uint32_t, 24> patches{0x735244, 0xC29682, 0x627A9D, 0x576C43, 0x8580B1, 0x67BDAA, 0xD67E2C, 0x505BA6,
                                                    0xC15A63, 0x5E3C6C, 0x9DBC40, 0xE0A32E, 0x383D96, 0x469449, 0xAF363C, 0xE7C71F,
                                                    0xBB5695, 0x0885A1, 0xF3F3F2, 0xC8C8C8, 0xA0A0A0, 0x7A7A79, 0x555555, 0x343434};
    Canvas canvas(768, 1024, srgb(0x202020));
    for (std::size_t i = 0; i < patches.size(); ++i) {
        const glm::vec2 at{static_cast<float>(i % 6), static_cast<float>(i / 6)};
        const glm::vec2 corner = glm::vec2(0.03F, 0.025F) + at * glm::vec2(0.158F, 0.118F);
        canvas.rectangle(corner, corner + glm::vec2(0.143F, 0.104F), srgb(patches[i]));
    }
    for (int hue = 0; hue < 12; ++hue) {
        const float angle = static_cast<float>(hue) / 12.0F;
        const auto lobe = [angle](float offset) {
            return std::clamp(std::abs(std::fmod(angle + offset, 1.0F) * 6.0F - 3.0F) - 1.0F, 0.0F, 1.0F);
        };
        const glm::vec3 pure(lobe(0.0F), lobe(2.0F / 3.0F), lobe(1.0F / 3.0F));
        for (int step = 0; step < 3; ++step) {
            const float lightness = std::array{0.75F, 0.3F, 0.1F}[static_cast<std::size_t>(step)];
            const glm::vec2 corner{0.03F + 0.0787F * static_cast<float>(hue), 0.515F + 0.065F * static_cast<float>(step)};
            canvas.rectangle(corner, corner + glm::vec2(0.0737F, 0.06F), pure * lightness + 0.015F);
        }
    }
    const glm::vec3 red = srgb(0xB01818), green = srgb(0x176B3A), blue = srgb(0x1B3FA0);
    canvas.rectangle({0.03F, 0.73F}, {0.49F, 0.975F}, red);
    canvas.rectangle({0.51F, 0.73F}, {0.97F, 0.975F}, blue);
    canvas.disc({0.26F, 0.852F}, 0.085F, green);
    canvas.disc({0.74F, 0.852F}, 0.085F, red);
    canvas.text({0.175F, 0.838F}, 0.028F, "GREEN", red);
    canvas.text({0.693F, 0.838F}, 0.028F, "RED", blue);
    return canvas;
}

// A test of fine detail: bars of falling period, a Siemens star, and print of several sizes.
Canvas paint_stripes_poster() {
    Canvas canvas(768, 1024, white_paper);
    const glm::vec3 navy = srgb(0x14306E), orange = srgb(0xE8731A), teal = srgb(0x0F8F8A);
    const glm::vec2 star{0.5F, 0.28F};
    canvas.shade([&](glm::vec2 p) {
        const glm::vec2 from_star = (p - star) * glm::vec2(0.75F, 1.0F);
        if (glm::length(from_star) < 0.24F) { return std::sin(36.0F * std::atan2(from_star.y, from_star.x)) > 0 ? navy : white_paper; }
        if (p.y > 0.56F && p.y < 0.74F && p.x > 0.06F && p.x < 0.94F) {
            const float step = std::floor((p.x - 0.06F) / 0.88F * 6.0F);  // bars of 32, 16 … 1 pixels' half period
            const float half_period = 32.0F / std::exp2(step);
            const glm::vec3 colour = p.y < 0.65F ? ink : orange;
            return std::fmod(p.x * 768.0F, 2.0F * half_period) < half_period ? colour : white_paper;
        }
        return white_paper;
    });
    canvas.text({0.06F, 0.765F}, 0.05F, "ENTOPTIC OFFICE", navy);
    canvas.text({0.06F, 0.835F}, 0.028F, "WHAT THE EYE ADDS TO LIGHT", teal);
    canvas.text({0.06F, 0.885F}, 0.018F, "GLARE, ADAPTATION, COLOUR, ACUITY", ink);
    canvas.text({0.06F, 0.92F}, 0.0123F, "IN THE DARK THE RODS SEE NEITHER RED NOR PRINT", ink);
    canvas.text({0.06F, 0.95F}, 0.0082F, "WHO READS THIS LINE HAS A BRIGHT LAMP OR GOOD EYES", ink);
    return canvas;
}

Canvas paint_book_spines() {
    constexpr std::array<std::uint32_t, spines_per_texture> covers{0xA3211F, 0x1D4E89, 0xE2B33C, 0x20603D, 0x5A2A6B, 0xD8D2C4,
                                                                   0x202428, 0xC8571B, 0x0E7C7B, 0x7A1F3D, 0x3B6FB6, 0x8C9A2B,
                                                                   0xF0EDE4, 0x4A2F1B, 0xB8336A, 0x2E3A59};
    constexpr std::array titles{"OPTICS", "GLARE", "THE RETINA", "COLOUR", "NIGHT SKY", "PURKINJE", "VISION", "LAMPS",
                                "RODS",   "CONES", "PUPILS",     "HALOS",  "STARS",     "PHOTONS",  "LENSES", "NOISE"};
    // Painted lying down (letters upright, one book a row); the scene turns it by mapping u along the spine.
    Canvas canvas(512, 1024, glm::vec3(0));
    for (int i = 0; i < spines_per_texture; ++i) {
        const auto index = static_cast<std::size_t>(i);
        const float top = static_cast<float>(i) / spines_per_texture, height = 1.0F / spines_per_texture;
        const glm::vec3 cover = srgb(covers[index]);
        const bool light_cover = cover.y > 0.3F;
        const glm::vec3 print = light_cover ? srgb(0x1C2A48) : srgb(i % 3 == 0 ? 0xE8C872 : 0xEDE8DC);
        canvas.rectangle({0, top}, {1, top + height}, cover);
        for (const float x : {0.06F, 0.085F, 0.9F, 0.925F}) { canvas.rectangle({x, top}, {x + 0.012F, top + height}, print); }
        canvas.text({0.16F, top + 0.27F * height}, 0.46F * height, titles[index], print);
    }
    return canvas;
}

Canvas paint_keyboard() {
    Canvas canvas(512, 192, srgb(0x2A2C2F));
    constexpr std::string_view letters = "1234567890-/QWERTYUIOP::ASDFGHJKL:,.ZXCVBNM,.-/-";
    for (int row = 0; row < 5; ++row) {
        for (int column = 0; column < 15; ++column) {
            const glm::vec2 key{0.02F + static_cast<float>(column) * 0.0642F, 0.06F + static_cast<float>(row) * 0.18F};
            const bool space = row == 4 && column > 3 && column < 10;
            if (space && column > 4) { continue; }
            const float width = space ? 0.0642F * 6 - 0.008F : 0.056F;
            canvas.rectangle(key, key + glm::vec2(width, 0.15F), srgb(0x4A4D52));
            if (row < 4 && column > 1 && column < 14) {
                const auto letter = static_cast<std::size_t>(row * 12 + column - 2);
                canvas.text(key + glm::vec2(0.017F, 0.035F), 0.075F, letters.substr(letter, 1), srgb(0xD8D8D8));
            }
        }
    }
    return canvas;
}

// A page of print: a heading, lines of words, a small bar chart in colour.
Canvas paint_paper() {
    constexpr std::array words{"LIGHT", "OF",   "THE",   "LAMP", "FALLS", "ON",   "PAPER", "AND",   "EYE", "SEES",
                               "A",     "HALO", "ROUND", "IT",   "WHILE", "DARK", "ROOM",  "FADES", "TO",  "GREY"};
    Canvas canvas(512, 724, white_paper);
    canvas.text({0.1F, 0.06F}, 0.028F, "SEEING IN THE DARK", srgb(0x8A1414));
    std::uint32_t next = 0;
    for (float y = 0.125F; y < 0.93F; y += 0.0235F) {
        float x = 0.1F;
        const bool beside_chart = y > 0.47F && y < 0.71F;
        while (true) {
            const std::string_view word = words[static_cast<std::size_t>(hash01(next++, 5) * static_cast<float>(words.size()))];
            const float width = canvas.text_width(0.0125F, word);
            if (x + width > (beside_chart ? 0.5F : 0.92F)) { break; }
            canvas.text({x, y}, 0.0125F, word, ink);
            x += width + canvas.text_width(0.0125F, " ");
        }
    }
    constexpr std::array<std::uint32_t, 5> bars{0xC0272D, 0x2D7DD2, 0x3BA55D, 0xF2A900, 0x7B3FA0};
    for (int i = 0; i < 5; ++i) {
        const float x = 0.56F + 0.07F * static_cast<float>(i);
        canvas.rectangle({x, 0.69F - 0.2F * hash01(static_cast<std::uint32_t>(i), 8)}, {x + 0.05F, 0.7F},
                         srgb(bars[static_cast<std::size_t>(i)]));
    }
    return canvas;
}

// A monitor that is off: its frame, its dark glass, a sticker.
Canvas paint_screen() {
    Canvas canvas(512, 320, srgb(0x26282B));
    canvas.rectangle({0.018F, 0.028F}, {0.982F, 0.93F}, glm::vec3(0.012F));
    canvas.text({0.45F, 0.95F}, 0.025F, "ENTOPTIC", srgb(0x9A9CA0));
    canvas.rectangle({0.05F, 0.09F}, {0.14F, 0.235F}, srgb(0xF4E04D));  // a yellow note
    canvas.text({0.06F, 0.115F}, 0.03F, "CALL", ink);
    canvas.text({0.06F, 0.165F}, 0.03F, "PURK", ink);
    return canvas;
}

Canvas paint_mug() {
    Canvas canvas(512, 256, srgb(0xE9E4DA));
    canvas.rectangle({0, 0.10F}, {1, 0.17F}, srgb(0x1F5FA8));
    canvas.rectangle({0, 0.83F}, {1, 0.90F}, srgb(0x1F5FA8));
    for (int i = 0; i < 4; ++i) {
        canvas.disc({0.125F + 0.25F * static_cast<float>(i), 0.5F}, 0.2F, srgb(i % 2 == 0 ? 0xC3272B : 0x2B8A3E));
        canvas.disc({0.125F + 0.25F * static_cast<float>(i), 0.5F}, 0.1F, srgb(0xE9E4DA));
    }
    return canvas;
}

Canvas paint_calendar() {
    Canvas canvas(512, 512, white_paper);
    canvas.rectangle({0, 0}, {1, 0.2F}, srgb(0xB3242A));
    canvas.text({0.18F, 0.055F}, 0.09F, "NOVEMBER", white_paper);
    for (int day = 1; day <= 30; ++day) {
        const glm::vec2 cell{static_cast<float>((day + 6) % 7), static_cast<float>((day + 6) / 7 - 1)};
        const glm::vec2 at = glm::vec2(0.06F, 0.27F) + cell * glm::vec2(0.13F, 0.14F);
        canvas.text(at, 0.055F, std::to_string(day), (day + 6) % 7 == 6 ? srgb(0xB3242A) : ink);
    }
    return canvas;
}

// The view from the window as luminance over that of the sky: clouds, hills, houses and trees on the horizon. Landscape of
// albedo near 0.2 under a uniform sky has a fifth of its luminance.
Canvas paint_outdoors() {
    Canvas canvas(1024, 512, glm::vec3(0));
    constexpr float horizon = 0.78F;
    canvas.shade([](glm::vec2 p) {
        const float elevation = (horizon - p.y) / horizon;
        const float hill = 0.03F + 0.05F * tiling_noise({p.x * 6.0F, 0.5F}, 6, 61) + 0.008F * tiling_noise({p.x * 64.0F, 0.5F}, 64, 62);
        if (elevation < hill) {
            const float leaves = tiling_noise(p * glm::vec2(128.0F, 64.0F), 128, 63);
            const glm::vec3 land = p.y < horizon ? glm::mix(srgb(0x3D5535), srgb(0x5C7446), leaves) : srgb(0x66704F);
            return land * (p.y < horizon ? 1.0F : 0.9F + 0.2F * leaves);
        }
        float cloud = 0.0F, weight = 0.5F;
        for (std::uint32_t octave = 1; octave <= 16; octave *= 2) {
            cloud += weight * tiling_noise(p * glm::vec2(6.0F, 5.0F) * static_cast<float>(octave), 6 * octave, 70 + octave);
            weight *= 0.5F;
        }
        const float cover = glm::smoothstep(0.42F, 0.7F, cloud);
        const glm::vec3 clear = glm::mix(glm::vec3(0.72F, 0.75F, 0.80F), glm::vec3(0.42F, 0.52F, 0.72F), std::sqrt(elevation));
        return glm::mix(clear, glm::vec3(0.88F), cover);
    });
    for (std::uint32_t i = 0; i < 26; ++i) {
        const float x = hash01(i, 1, 90), width = 0.008F + 0.012F * hash01(i, 2, 90), height = 0.03F + 0.05F * hash01(i, 3, 90);
        const glm::vec3 wall = glm::mix(srgb(0x8C7A6B), srgb(0xB7A896), hash01(i, 4, 90)) * 0.6F;
        canvas.rectangle({x, horizon - height}, {x + width, horizon + 0.02F}, wall);
        canvas.rectangle({x - 0.001F, horizon - height - 0.008F}, {x + width + 0.001F, horizon - height}, srgb(0x7C3B2E) * 0.7F);
        for (int w = 0; w < 4; ++w) {
            const glm::vec2 pane{x + width * (0.15F + 0.45F * static_cast<float>(w % 2)),
                                 horizon - height * (0.8F - 0.4F * static_cast<float>(w / 2))};
            canvas.rectangle(pane, pane + glm::vec2(width * 0.25F, 0.012F), srgb(0x3A4450) * 0.7F);
        }
    }
    return canvas;
}

using Painter = Canvas (*)();
constexpr std::array<Painter, static_cast<std::size_t>(Material::count)> painters{
    paint_plain,         paint_wood,           paint_floor,       paint_plaster,  paint_fabric, paint_acuity_chart,
    paint_colour_poster, paint_stripes_poster, paint_book_spines, paint_keyboard, paint_paper,  paint_screen,
    paint_mug,           paint_calendar,       paint_outdoors};

}  // namespace

std::vector<Canvas> paint_materials() {
    std::vector<std::optional<Canvas>> painted(painters.size());
    std::atomic<std::size_t> next = 0;
    const auto work = [&] {
        for (std::size_t i = next++; i < painters.size(); i = next++) { painted[i] = painters[i](); }
    };
    {
        std::vector<std::jthread> threads;
        for (unsigned i = 1; i < std::max(std::thread::hardware_concurrency(), 1U); ++i) { threads.emplace_back(work); }
        work();
    }
    std::vector<Canvas> canvases;
    for (auto& canvas : painted) { canvases.push_back(std::move(*canvas)); }
    return canvases;
}

}  // namespace samples
